"""What the plots share: matplotlib, or an exit status that tells that there is none, colours and style.

The beginning of each program that host/plot/python.cpp runs.
"""

import sys

NO_MATPLOTLIB = 3  # exit status, read by host/plot/python.cpp

# Python looks into the current folder first when a program comes by -c: a stray file there must not stand in for a module.
sys.path = [folder for folder in sys.path if folder]

import json
import math

try:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib import rc_context
except ImportError:
    sys.exit(NO_MATPLOTLIB)

# Okabe & Ito 2008, "Color Universal Design": told apart by colour-blind readers.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#f0e442"]
DASHES = ["-", "--", "-.", ":"]
STYLE = {
    "font.size": 11,
    "axes.titlesize": 13,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": "#dddddd",
    "text.parse_math": False,  # a dollar sign in a label is a dollar sign
}


def colour(i):
    return COLOURS[i % len(COLOURS)]


def dash(i):
    return DASHES[i // len(COLOURS) % len(DASHES)]


def numbers(values):
    return [math.nan if value is None else value for value in values]
