"""What all plots of a bench share: size, numbers, ticks.

Runs behind host/plot/style.py, whose names it uses.
"""

import io
import textwrap

from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

WIDTH = 9.6  # inches, of every plot
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def number(value, digits=2):
    """0.0012, 25, 3·10⁻⁶; text.parse_math is off, so that matplotlib's own powers of ten would not show."""
    if value == 0 or 0.99e-4 < abs(value) < 1e5:
        magnitude = 0 if value == 0 else math.floor(math.log10(abs(value)))
        return f"{round(value, max(digits - 1 - magnitude, 0)):.10g}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    power = "10" + str(int(exponent)).translate(SUPERSCRIPTS)
    mantissa = f"{float(mantissa):g}"
    return power if mantissa == "1" else mantissa + "·" + power


def wrapped(label, width, lines):
    return "\n".join(textwrap.wrap(label, width, max_lines=lines, placeholder="…") or [""])


def set_log_ticks(axis, steps):
    """Labels at the steps times powers of ten, ticks at all nine."""
    axis.set_major_locator(LogLocator(subs=steps, numticks=20))
    axis.set_minor_locator(LogLocator(subs=range(1, 10), numticks=20))
    axis.set_major_formatter(FuncFormatter(lambda value, _: number(value, 3)))
    axis.set_minor_formatter(NullFormatter())


def png(figure):
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return file.getvalue()
