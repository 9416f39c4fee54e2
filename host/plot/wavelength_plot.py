"""Draws errors from wavelengths alone: JSON as `tristim bench-wavelengths --json` prints it on standard input, PNG on
standard output. Runs behind host/plot/style.py and bench_style.py, whose names it uses.
"""

from matplotlib.lines import Line2D
from PIL import Image

MOST_PANELS_IN_ROW = 3
PANEL_HEIGHT = 3.2  # inches
LEGEND_COLUMNS = 4
PALETTE = 64  # colours


def label(method):
    return f"{method['method']} {method['sequence']}"


def draw(axes, scene, labels):
    for method in scene["methods"]:
        i = labels.index(label(method))
        passes, rmse, errors = method["passes"], method["rmse"], method["rmse_standard_error"]
        axes.plot(passes, rmse, color=colour(i), linestyle=dash(i), linewidth=1.5, label=label(method))
        low = [max(r - e, r / 10) for r, e in zip(rmse, errors)]
        high = [r + e for r, e in zip(rmse, errors)]
        axes.fill_between(passes, low, high, color=colour(i), alpha=0.15, linewidth=0)
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        set_log_ticks(axis, (1,))
    axes.set_title(scene["name"], loc="left")


def draw_legend(axes, labels):
    handles = [Line2D([], [], color=colour(i), linestyle=dash(i), linewidth=1.5) for i in range(len(labels))]
    axes.set_axis_off()
    axes.legend(handles, labels, loc="center", ncol=LEGEND_COLUMNS, frameon=False)


def small_png(figure):
    """A palette is enough for lines, and makes the file half as large."""
    file = io.BytesIO()
    Image.open(io.BytesIO(png(figure))).convert("RGB").quantize(PALETTE).save(file, format="PNG", optimize=True)
    return file.getvalue()


def main():
    scenes = json.load(sys.stdin)
    labels = list(dict.fromkeys(label(method) for scene in scenes for method in scene["methods"]))
    columns = min(len(scenes), MOST_PANELS_IN_ROW)
    rows = math.ceil(len(scenes) / columns)
    legend_height = 0.2 * math.ceil(len(labels) / LEGEND_COLUMNS) + 0.2
    with rc_context({**STYLE, "font.size": 9, "axes.titlesize": 10}):
        figure = Figure(figsize=(WIDTH, PANEL_HEIGHT * rows + legend_height), dpi=100, layout="constrained")
        FigureCanvasAgg(figure)
        grid = figure.add_gridspec(rows + 1, columns, height_ratios=[PANEL_HEIGHT] * rows + [legend_height])
        first = None
        for i, scene in enumerate(scenes):
            axes = figure.add_subplot(grid[i // columns, i % columns], sharex=first, sharey=first)
            first = first or axes
            draw(axes, scene, labels)
            if i % columns == 0:
                axes.set_ylabel("RMSE in XYZ")
            if i + columns >= len(scenes):
                axes.set_xlabel("passes")
        draw_legend(figure.add_subplot(grid[rows, :]), labels)
        sys.stdout.buffer.write(small_png(figure))


main()
