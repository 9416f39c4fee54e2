"""Draws the plots of a bench: JSON as host/plot/bench_plots.cpp writes it on standard input; on standard output, for
each plot, a line with its size in bytes and its file name, and then the PNG file's bytes.

Runs behind host/plot/style.py, bench_style.py and bench_images.py, whose names it uses.
"""

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

MARKERS = ["o", "s", "^", "D", "v", "P", "X"]  # one fewer than colours: no pair comes again before all have been seen
GREY = "#666666"
MANY_RUNS = 8  # a legend of more is set in smaller letters
MOST_BARS = 36
MOST_LEVELS = 6
MOST_PANELS_IN_ROW = 3


def finite(values):
    return [value for value in values if value is not None and math.isfinite(value) and value > 0]


def marker(i):
    return MARKERS[i % len(MARKERS)]


def region_title(scene, r):
    return "whole image" if r == 0 else scene["regions"][r]["name"]


def log_axis(axis, low, high):
    """From low to high, a factor of two at least; labels at 1, 2 and 5 where there is room, else at powers of ten."""
    axes = axis.axes
    widening = max(1, math.sqrt(2.2 * low / high))
    low, high = low / widening, high * widening
    if axis is axes.xaxis:
        axes.set_xscale("log")
        axes.set_xlim(low, high)
    else:
        axes.set_yscale("log")
        axes.set_ylim(low, high)
    steps = (1, 2, 5) if math.log10(high / low) < 2.5 else (1,)
    set_log_ticks(axis, steps)


def new_figure(height):
    figure = Figure(figsize=(WIDTH, height), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def legend_labels(group):
    lines = 2 if len(group["runs"]) > MANY_RUNS else 3
    return [wrapped(label, 24, lines) for label in group["labels"]]


def legend_height(labels):
    """In inches, with its title."""
    return 0.6 + sum((0.15 if len(labels) > MANY_RUNS else 0.18) * (label.count("\n") + 1) + 0.05 for label in labels)


def add_legend(axes, handles, title):
    """To the right of the axes, where no curve can run through it."""
    axes.legend(
        handles=handles,
        title=wrapped(title, 26, 3),
        loc="upper left",
        bbox_to_anchor=(1.01, 1.02),
        frameon=False,
        fontsize=8.5 if len(handles) > MANY_RUNS else 10,
        alignment="left",
        handlelength=2.6,
    )


def curve_of(scene, group, position, r):
    return scene["summary"]["curves"][group["runs"][position]][r]


def note_nothing(axes, words):
    axes.text(0.5, 0.5, words, transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set_xticks([])
    axes.set_yticks([])


def draw_floor(axes, floor, bottom, has_hollow):
    words = f"reference's own error, {number(floor)}"
    if floor < bottom:
        axes.text(
            0.01, 0.015, words + ": below the axis", transform=axes.transAxes, color=GREY, fontsize=9, va="bottom"
        )
        return
    axes.axhspan(bottom / 10, floor, color="#000000", alpha=0.07, linewidth=0)
    axes.axhline(floor, color=GREY, linestyle=(0, (5, 3)), linewidth=1.2)
    axes.annotate(
        words + ("; hollow points: less than three times that" if has_hollow else ""),
        (0.01, floor),
        xycoords=("axes fraction", "data"),
        xytext=(0, -4),
        textcoords="offset points",
        va="top",
        color=GREY,
        fontsize=9,
    )


def draw_time(scene, group, r):
    labels = legend_labels(group)
    figure = new_figure(max(5.4, legend_height(labels)))
    axes = figure.subplots()
    floor = scene["reference"]["floor"][r]
    handles, times, errors = [], [], []
    has_hollow = False
    for i in range(len(labels)):
        curve = curve_of(scene, group, i, r)
        x, y, low, high = (numbers(curve[key]) for key in ("seconds", "median", "low", "high"))
        label = labels[i] + ("" if finite(y) else "\n(no points)")
        style = {"color": colour(i), "linestyle": dash(i), "linewidth": 1.8}
        handles.append(Line2D([], [], marker=marker(i), markersize=5, label=label, **style))
        if not finite(y):
            continue
        times += finite(x)
        errors += finite(y) + finite(low) + finite(high)
        axes.fill_between(x, low, high, color=colour(i), alpha=0.18, linewidth=0)
        axes.plot(x, y, **style)
        hollow_from = math.inf if curve["near_floor_from"] is None else curve["near_floor_from"]
        for hollow in (False, True):
            points = [(a, b) for a, b in zip(x, y) if b > 0 and (a >= hollow_from) == hollow]
            has_hollow = has_hollow or (hollow and bool(points))
            axes.plot(
                [a for a, _ in points],
                [b for _, b in points],
                linestyle="none",
                marker=marker(i),
                markersize=5,
                color=colour(i),
                markerfacecolor="white" if hollow else colour(i),
            )
    if errors and times:
        bottom, top = min(errors) / 1.3, max(errors) * 1.3
        if floor > bottom / 6:  # else it would squeeze the curves
            bottom, top = min(bottom, floor / 1.7), max(top, floor * 1.3)
        log_axis(axes.xaxis, min(times) / 1.15, max(times) * 1.15)
        log_axis(axes.yaxis, bottom, top)
        if floor > 0:
            draw_floor(axes, floor, bottom, has_hollow)
    else:
        note_nothing(axes, "nothing measured yet")
    axes.set_title(f"{scene['name']}, {region_title(scene, r)}", loc="left")
    axes.set_xlabel("rendering time [s]")
    axes.set_ylabel("RMSE in XYZ")
    add_legend(axes, handles, group["title"])
    return png(figure)


def evenly(values, most):
    if len(values) <= most:
        return values
    if most == 1:
        return values[-1:]
    return [values[round(i * (len(values) - 1) / (most - 1))] for i in range(most)]


def draw_bars(scene, group, r):
    summary = scene["summary"]["groups"][scene["groups"].index(group)][r]
    count = len(group["runs"])
    rows = sorted(zip(summary["levels"], summary["times"]), key=lambda row: -row[0])
    rows = evenly(rows, max(2, min(MOST_LEVELS, MOST_BARS // max(count, 1))))
    ends = [max(finite(curve_of(scene, group, i, r)["seconds"]), default=None) for i in range(count)]
    lengths = finite([time for _, times in rows for time in times] + ends)
    bar = 0.19 if count > 1 else 0.3  # inches
    labels = legend_labels(group)
    figure = new_figure(max(2.7, 1.1 + len(rows) * (count * bar + 0.16), legend_height(labels)))
    axes = figure.subplots()
    handles = [Patch(label=label, **bar_style(i)) for i, label in enumerate(labels)]
    axes.set_title(f"{scene['name']}, {region_title(scene, r)}: time to reach an error", loc="left")
    axes.set_xlabel("rendering time [s]")
    axes.set_ylabel("RMSE in XYZ, at most")
    if rows and lengths:
        left, longest = min(lengths) / 2, max(lengths)
        log_axis(axes.xaxis, left, longest * max(longest / left, 4) ** 0.22)  # room for the words behind a bar
        left = axes.get_xlim()[0]
        thickness = 1 / (count + 0.8)
        for level, (_, times) in enumerate(rows):
            for i, time in enumerate(times):
                y = level + (i - (count - 1) / 2) * thickness
                draw_bar(axes, y, 0.86 * thickness, left, time, ends[i], curve_of(scene, group, i, r)["seconds"], i)
        axes.set_yticks(range(len(rows)), [number(error) for error, _ in rows])
        axes.set_ylim(len(rows) - 0.5, -0.5)
        axes.tick_params(axis="y", length=0)
        axes.grid(False, axis="y")
    else:
        note_nothing(axes, "nothing measured yet")
    add_legend(axes, handles, group["title"])
    return png(figure)


def bar_style(i):
    """Colours come again after the last one: those bars are hatched."""
    return {"facecolor": colour(i), "edgecolor": "white", "linewidth": 0, "hatch": "xxx" if i >= len(COLOURS) else None}


def draw_bar(axes, y, height, left, time, end, seconds, i):
    """A bar to the time, or a pale one to the run's end where it did not get there."""
    if time is not None:
        axes.barh(y, time - left, height, left=left, **bar_style(i))
        words = ("≤ " if time <= seconds[0] else "") + number(time) + " s"
    elif end is not None:
        axes.barh(y, end - left, height, left=left, facecolor="none", edgecolor=colour(i), hatch="////", alpha=0.35)
        words = f"not within {number(end)} s"
    else:
        words = "not measured"
    axes.annotate(
        words,
        (time or end or left, y),
        xytext=(4, 0),
        textcoords="offset points",
        va="center_baseline",
        fontsize=8.5,
        color="#000000" if time is not None else GREY,
    )


def memory_at(run, seconds):
    """Bytes: the most that any repeat had used at its last checkpoint until then."""
    return max(
        (
            checkpoint["memory"]
            for repeat in run["repeats"]
            for checkpoint in repeat["checkpoints"]
            if checkpoint["seconds"] <= seconds * (1 + 1e-9)
        ),
        default=None,
    )


def spread_at(curve, seconds):
    """Low and high, linear in logarithms between the curve's points, as the median is."""
    x = curve["seconds"]
    after = next((i for i, value in enumerate(x) if value >= seconds * (1 - 1e-9)), None)
    if after is None:
        return None
    before = max(after - 1, 0)
    span = math.log(x[after] / x[before]) if after > before else 0
    share = math.log(seconds / x[before]) / span if span > 0 else 1
    pair = []
    for key in ("low", "high"):
        ends = finite([curve[key][before], curve[key][after]])
        if len(ends) < 2:
            return None
        pair.append(math.exp((1 - share) * math.log(ends[0]) + share * math.log(ends[1])))
    return pair


def draw_memory(scene, group):
    regions = scene["summary"]["groups"][scene["groups"].index(group)]
    columns = min(len(regions), MOST_PANELS_IN_ROW)
    rows = math.ceil(len(regions) / columns)
    labels = legend_labels(group)
    figure = new_figure(max(1.2 + 3.2 * rows, 0.5 + legend_height(labels)))
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    handles = [
        Line2D([], [], color=colour(i), marker=marker(i), linestyle="none", label=label)
        for i, label in enumerate(labels)
    ]
    for panel in panels[len(regions) :]:
        panel.set_axis_off()
    for r, (axes, summary) in enumerate(zip(panels, regions)):
        draw_memory_panel(axes, scene, group, r, summary)
        axes.set_title(region_title(scene, r), loc="left", fontsize=11)
        axes.set_xlabel("device memory [MB]")
        if r % columns == 0:
            axes.set_ylabel("RMSE in XYZ")
    time = regions[0]["equal_time"] if regions else None
    after = f" after {number(time)} s" if time else ""
    figure.suptitle(f"{scene['name']}: error{after} and memory", x=0.01, ha="left", fontsize=13)
    add_legend(panels[columns - 1], handles, group["title"])
    return png(figure)


def draw_memory_panel(axes, scene, group, r, summary):
    time = summary["equal_time"]
    points = []
    for i, (run, error) in enumerate(zip(group["runs"], summary["errors"])):
        memory = memory_at(scene["runs"][run], time) if time else None
        if memory and error:
            points.append((i, memory / 1e6, error, spread_at(curve_of(scene, group, i, r), time) or [error, error]))
    if not points:
        note_nothing(axes, "nothing measured yet")
        return
    for i, memory, error, spread in points:
        axes.plot([memory, memory], spread, color=colour(i), linewidth=1.5)
        axes.plot([memory], [error], color=colour(i), marker=marker(i), markersize=8)
    ends = [value for point in points for value in point[3]]
    memories = [point[1] for point in points]
    log_axis(axes.yaxis, min(ends) / 1.3, max(ends) * 1.3)
    if max(memories) > 4 * min(memories):
        log_axis(axes.xaxis, min(memories) / 1.4, max(memories) * 1.4)
    else:
        axes.set_xlim(0, 1.1 * max(memories))


def draw_scene(scene, folder, error_map):
    for group in scene["groups"]:
        name = f"{scene['name']}-{group['name']}"
        for r, region in enumerate(scene["regions"]):
            yield f"{name}-{region['name']}-time.png", draw_time(scene, group, r)
            yield f"{name}-{region['name']}-bars.png", draw_bars(scene, group, r)
        yield f"{name}-memory.png", draw_memory(scene, group)
    yield f"{scene['name']}-images.png", draw_images(scene, folder, error_map)


def main():
    task = json.load(sys.stdin)
    with rc_context(STYLE):
        for scene in task["scenes"]:
            for name, data in draw_scene(scene, task["folder"], task["error_map"]):
                if data is not None:
                    sys.stdout.buffer.write(f"{len(data)} {name}\n".encode() + data)


main()
