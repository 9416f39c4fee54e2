"""The images of a scene's runs at equal time, each above its error map.

Runs behind host/plot/style.py and bench_style.py, whose names it uses.
"""

import os

from matplotlib import image as images
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.cm import ScalarMappable

FEWEST_PICTURE_COLUMNS, MOST_PICTURES_IN_ROW = 3, 5
PICTURE_GAP = 0.12  # inches


class Picture:
    def __init__(self, title, caption, image, error_map):
        self.title, self.caption, self.image, self.error_map = title, caption, image, error_map


def read_picture(folder, name):
    path = os.path.join(folder, name)
    return images.imread(path) if name and os.path.isfile(path) else None


def pictures_of(scene, folder):
    """The reference, then each run of which there is an image, with its error at its first group's equal time."""
    pictures = [Picture("reference", "", read_picture(folder, scene["image"]), None)]
    for index, run in enumerate(scene["runs"]):
        image = read_picture(folder, run["image"])
        if image is None:
            continue
        caption = ""
        for group, regions in zip(scene["groups"], scene["summary"]["groups"]):
            error = regions[0]["errors"][group["runs"].index(index)] if index in group["runs"] and regions else None
            if error:
                caption = f"RMSE {number(error, 3)} at {number(regions[0]['equal_time'])} s"
                break
        pictures.append(Picture(run["label"], caption, image, read_picture(folder, run["error_map"])))
    return pictures


def add_picture(figure, pixels, box):
    axes = figure.add_axes(box)
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(False)
    for side in axes.spines.values():
        side.set_visible(True)
        side.set_color("#bbbbbb")
        side.set_linewidth(0.6)
    if pixels is not None:
        axes.imshow(pixels, aspect="auto", cmap="gray")
    return axes


def add_colour_bar(figure, box, scale, error_map):
    norm = LogNorm(scale * 10 ** -error_map["decades"], scale)
    bar = figure.colorbar(
        ScalarMappable(norm, ListedColormap(error_map["colours"])),
        cax=figure.add_axes(box),
        orientation="horizontal",
        extend="neither",
    )
    set_log_ticks(bar.ax.xaxis, (1,))
    bar.ax.tick_params(labelsize=8)
    bar.set_label("error of a pixel,\nRMS over X, Y, Z", fontsize=9)


def draw_images(scene, folder, error_map):
    pictures = pictures_of(scene, folder)
    if len(pictures) == 1 and pictures[0].image is None:
        return None
    columns = max(FEWEST_PICTURE_COLUMNS, min(len(pictures), MOST_PICTURES_IN_ROW))
    rows = math.ceil(len(pictures) / columns)
    width = (WIDTH - PICTURE_GAP * (columns + 1)) / columns
    shape = next((p.image.shape for p in pictures if p.image is not None), (3, 4))
    height = min(max(width * shape[0] / shape[1], 0.6), 2.5 * width)
    titles = [wrapped(picture.title, int(13 * width), 2) for picture in pictures]
    title_height = 0.42 if any("\n" in title for title in titles) else 0.25
    caption_height, head = 0.34, 0.42
    row_height = title_height + 2 * height + 0.5 * PICTURE_GAP + caption_height
    total = head + rows * row_height + 0.1
    figure = Figure(figsize=(WIDTH, total), dpi=150)
    FigureCanvasAgg(figure)

    def box(x, y, w, h):
        """From inches, y downwards from the top, to parts of the figure."""
        return [x / WIDTH, 1 - (y + h) / total, w / WIDTH, h / total]

    figure.text(PICTURE_GAP / WIDTH, 1 - 0.1 / total, f"{scene['name']} at equal time", fontsize=13, va="top")
    for i, picture in enumerate(pictures):
        x = PICTURE_GAP + (i % columns) * (width + PICTURE_GAP)
        y = head + (i // columns) * row_height + title_height
        axes = add_picture(figure, picture.image, box(x, y, width, height))
        axes.set_title(titles[i], fontsize=9.5, pad=3, loc="left")
        y += height + 0.5 * PICTURE_GAP
        if i > 0:
            axes = add_picture(figure, picture.error_map, box(x, y, width, height))
            axes.set_xlabel(picture.caption, fontsize=9, labelpad=3)
        elif scene["error_map_scale"]:
            add_colour_bar(figure, box(x + 0.1, y + 0.15, width - 0.2, 0.14), scene["error_map_scale"], error_map)
    return png(figure)
