"""Draws a plot: JSON as host/plot/plot.cpp writes it on standard input, PNG on standard output.

Runs behind host/plot/style.py, whose names it uses.
"""

FEWEST_MARKED = 30  # a curve of fewer samples shows them
MOST_IN_LEGEND_COLUMN = 6


def draw_curves(axes, plot):
    for i, series in enumerate(plot["series"]):
        axes.plot(
            numbers(series["x"]),
            numbers(series["y"]),
            color=colour(i),
            linestyle=dash(i),
            linewidth=1.8,
            marker="o" if len(series["x"]) < FEWEST_MARKED else None,
            markersize=4,
            label=series["label"] or None,
        )
    xs = [x for series in plot["series"] for x in numbers(series["x"]) if math.isfinite(x)]
    if xs and min(xs) < max(xs):
        axes.set_xlim(min(xs), max(xs))
    axes.set_title(plot["title"], loc="left", wrap=True)
    axes.set_ylabel(plot["y_label"])
    labelled = sum(1 for series in plot["series"] if series["label"])
    if labelled > 0:
        axes.legend(
            frameon=True, framealpha=0.85, edgecolor="none", ncol=math.ceil(labelled / MOST_IN_LEGEND_COLUMN)
        )


def draw_strip(axes, plot):
    axes.imshow([plot["strip"]], extent=(0, 1, 0, 1), aspect="auto", interpolation="nearest")
    axes.set_yticks([])
    axes.set_xticks([])
    axes.grid(False)
    axes.set_ylabel(plot["strip_label"], rotation=0, ha="right", va="center")


def main():
    plot = json.load(sys.stdin)
    with rc_context(STYLE):
        figure = Figure(figsize=(9.6, 5.4), dpi=150, layout="constrained")
        FigureCanvasAgg(figure)
        if plot["strip"]:
            axes, strip_axes = figure.subplots(2, 1, gridspec_kw={"height_ratios": [5, 1]})
            draw_strip(strip_axes, plot)
            strip_axes.set_xlabel("")
        else:
            axes = figure.subplots()
        draw_curves(axes, plot)
        axes.set_xlabel(plot["x_label"])
        figure.savefig(sys.stdout.buffer, format="png")


main()
