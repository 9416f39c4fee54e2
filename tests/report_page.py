"""Opens FOLDER/report.html in headless Chromium and compares it with FOLDER/results.json.

Usage: report_page.py FOLDER, which tests/report_page_test.cpp has filled. Prints what is wrong and exits with 1.
"""

import io
import json
import os
import shutil
import sys

from PIL import Image
from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

problems = []


def expect(condition, what):
    if not condition:
        problems.append(what)


def expect_equal(found, wanted, what):
    expect(found == wanted, f"{what}: {found!r} instead of {wanted!r}")


def open_page(path):
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage"):
        options.add_argument(argument)
    options.add_argument("--window-size=1100,900")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    driver = webdriver.Chrome(service=Service(shutil.which("chromedriver")), options=options)
    driver.get("file://" + path)
    return driver


def texts(elements):
    return [" ".join(element.text.split()) for element in elements]


def rows(scene, caption):
    """Of the table under a caption that begins so, the rows' texts by their first cell."""
    for titled in scene.find_elements(By.CLASS_NAME, "titled"):
        if titled.find_element(By.CLASS_NAME, "caption").text.startswith(caption):
            cells = [texts(row.find_elements(By.XPATH, "./*")) for row in titled.find_elements(By.XPATH, ".//tbody/tr")]
            return {row[0]: row[1:] for row in cells}
    problems.append(f"no table {caption!r}")
    return {}


CHART = """
const chart = Chart.getChart(arguments[0]);
return {
    area: chart.chartArea,
    floor: chart.options.plugins.spreadAndFloor.floor,
    datasets: chart.data.datasets.map((dataset, i) => ({
        label: dataset.label,
        points: dataset.data,
        spread: dataset.spread,
        colour: dataset.borderColor,
        visible: chart.isDatasetVisible(i),
        hollow: dataset.pointBackgroundColor.map((colour) => colour !== dataset.borderColor),
        pixels: chart.getDatasetMeta(i).data.map((point) => [point.x, point.y]),
    })),
};
"""


def chart_of(driver, scene, kind):
    return driver.execute_script(CHART, scene.find_element(By.CSS_SELECTOR, f"canvas.{kind}"))


def check_time_chart(driver, scene, data, region, what):
    chart = chart_of(driver, scene, "time")
    group = data["groups"][0]
    expect_equal([dataset["label"] for dataset in chart["datasets"]], group["labels"], f"{what}: curves")
    for dataset, run in zip(chart["datasets"], group["runs"]):
        curve = data["summary"]["curves"][run][region]
        points = [{"x": x, "y": y} for x, y in zip(curve["seconds"], curve["median"])]
        expect_equal(dataset["points"], points, f"{what}: points of {dataset['label']}")
        expect_equal(dataset["spread"], {"low": curve["low"], "high": curve["high"]}, f"{what}: spread")
        floor = data["reference"]["floor"][region]
        hollow = [median <= 3 * floor for median in curve["median"]]
        expect_equal(dataset["hollow"], hollow, f"{what}: marks near the floor of {dataset['label']}")
        # Logarithmic axes: equal factors of time lie equally far apart, and each point lies within the axes.
        xs = [x for x, _ in dataset["pixels"]]
        steps = [b - a for a, b in zip(xs, xs[1:])]
        expect(steps and min(steps) > 5 and max(steps) - min(steps) < 0.01, f"{what}: spacing {steps}")
        area = chart["area"]
        inside = all(
            area["left"] <= x <= area["right"] and area["top"] <= y <= area["bottom"] for x, y in dataset["pixels"]
        )
        expect(inside, f"{what}: points outside of the axes")
    expect_equal(chart["floor"], data["reference"]["floor"][region], f"{what}: floor")


def check_colours(driver, scene, what):
    time, memory = (chart_of(driver, scene, kind)["datasets"] for kind in ("time", "memory"))
    colours = [dataset["colour"] for dataset in time]
    expect_equal(colours, ["#0072b2", "#d55e00", "#009e73"], f"{what}: colours")
    expect_equal([dataset["colour"] for dataset in memory], colours, f"{what}: colours over memory")


def check_memory_chart(driver, scene, data, region, what):
    chart = chart_of(driver, scene, "memory")
    errors = data["summary"]["groups"][0][region]["errors"]
    points = [[{"x": 2**i, "y": error}] for i, error in enumerate(errors)]  # MiB
    expect_equal([dataset["points"] for dataset in chart["datasets"]], points, f"{what}: memory")


def drawn_colours(driver, canvas, seconds, error, width):
    """The chart's colours at a time and error, as [red, green, blue], over so many pixels to its right."""
    read = """
    const [canvas, seconds, error, width] = arguments, { scales } = Chart.getChart(canvas);
    const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d", { willReadFrequently: true });
    copy.fillStyle = "white";
    copy.fillRect(0, 0, canvas.width, canvas.height);
    copy.drawImage(canvas, 0, 0);
    const ratio = canvas.width / canvas.clientWidth;
    const [x, y] = [scales.x.getPixelForValue(seconds), scales.y.getPixelForValue(error)];
    const bytes = copy.getImageData(x * ratio, y * ratio, width * ratio, 1).data;
    return Array.from({ length: bytes.length / 4 }, (_, i) => [...bytes.slice(4 * i, 4 * i + 3)]);
    """
    return driver.execute_script(read, canvas, seconds, error, width)


def check_drawing(driver, scene):
    """Point, spread and floor are on the canvas of the first scene's chart, in a light page."""
    canvas = scene.find_element(By.CSS_SELECTOR, "canvas.time")
    green = (0x00, 0x9E, 0x73)  # of the third run, 0.4 / sqrt(t); nothing else is drawn near it at 8 s
    median = 0.4 / 8**0.5
    point = drawn_colours(driver, canvas, 8, median, 1)[0]
    expect(max(abs(a - b) for a, b in zip(point, green)) < 3, f"point drawn in {point}")
    tint = [255 + 0.18 * (value - 255) for value in green]
    for factor in (0.88, 1.12):  # the spread goes from 0.8 to 1.2
        band = drawn_colours(driver, canvas, 8, factor * median, 1)[0]
        expect(max(abs(a - b) for a, b in zip(band, tint)) < 3, f"spread drawn in {band}")
    expect_equal(drawn_colours(driver, canvas, 8, 1.4 * median, 1)[0], [255, 255, 255], "colour above the spread")
    floor = [sum(colour) / 3 for colour in drawn_colours(driver, canvas, 2.1, 0.01, 30)]
    expect(min(floor) < 100 and max(floor) > 200, f"dashed floor drawn in {floor}")
    marked, free = (drawn_colours(driver, canvas, 1.5, error, 1)[0] for error in (0.029, 0.031))
    expect(marked[0] < 245 and free == [255, 255, 255], f"marked part {marked}, above it {free}")


def check_hover(driver, scene, data):
    canvas = scene.find_element(By.CSS_SELECTOR, "canvas.time")
    driver.execute_script("arguments[0].scrollIntoView({ block: 'center' })", canvas)
    chart = chart_of(driver, scene, "time")
    run, point = 1, 4
    x, y = chart["datasets"][run]["pixels"][point]
    size = canvas.size
    move = ActionChains(driver)
    move.move_to_element_with_offset(canvas, round(x - size["width"] / 2), round(y - size["height"] / 2)).perform()
    tooltip = """
    const { opacity, title, body } = Chart.getChart(arguments[0]).tooltip;
    return opacity === 1 ? [...title, ...body.flatMap((part) => part.lines)] : null;
    """
    # The chart answers to the pointer with the next frame.
    shown = WebDriverWait(driver, 5).until(lambda _: driver.execute_script(tooltip, canvas), "no tooltip")
    # c / sqrt(t) at t = 16 with c = 0.2, and 20 % less and more; relMSE: the median of 0.04² and 0.06²; 10 passes per
    # second.
    lines = ["16 s: RMSE 0.0500", "spread 0.0400 – 0.0600", "relMSE 0.00260", "160 passes"]
    expect_equal(shown, [data["runs"][run]["label"], *lines], "tooltip")
    canvas.send_keys(Keys.ARROW_RIGHT)
    title = driver.execute_script(tooltip, canvas)[0]
    expect_equal(title, data["runs"][0]["label"], "tooltip by keyboard")


def check_tables(scene, data):
    labels = [run["label"] for run in data["runs"]]
    reached = rows(scene, "Time to reach")
    expect_equal(reached.get("0.1"), ["1 s", "4 s × 4.0", "16 s × 16.0"], "time to reach 0.1")
    expect_equal(reached.get("0.02"), ["25 s", "–", "–"], "time to reach 0.02")
    ends = rows(scene, "After 64 s of rendering")
    wanted = [
        ["0.0125", "0.0100 – 0.0150", "× 0.50", "−0.50", "× 4.0", "best", "640", "64\u202f000"],
        ["0.0250", "0.0200 – 0.0300", "baseline", "−0.50", "× 4.0", "1 s", "640", "64\u202f000"],
        ["0.0500", "0.0400 – 0.0600", "× 2.0", "−0.50", "× 4.0", "1 s", "640", "64\u202f000"],
    ]
    wanted = [[" ".join(cell.split()) for cell in row] for row in wanted]
    expect_equal(ends, dict(zip(labels, wanted)), "runs")
    memory = rows(scene, "Device memory")
    expect_equal(memory.get(labels[1]), ["2.00 MiB", "1.14 MiB", "293 KiB", "97.7 KiB", "64.0 B", "140 B"], "memory")
    reference = rows(scene, "The reference")
    expect_equal(reference.get("whole image"), ["0.00800", "0.00600", "0.0100", "0.0300"], "reference")


def check_legend(driver, scene):
    buttons = scene.find_elements(By.CSS_SELECTOR, ".legend button")
    for pressed in ("false", "true"):
        buttons[1].click()
        expect_equal(buttons[1].get_attribute("aria-pressed"), pressed, "legend")
        for kind in ("time", "memory"):
            visible = [dataset["visible"] for dataset in chart_of(driver, scene, kind)["datasets"]]
            expect_equal(visible, [True, pressed == "true", True], f"curves shown in the {kind} chart")


def decoded_width(driver, image):
    script = "const [image, done] = arguments; image.decode().then(() => done(image.naturalWidth), () => done(0))"
    return driver.execute_async_script(script, image)


def check_images(driver, scene, data, what):
    images = scene.find_elements(By.TAG_NAME, "img")
    expect_equal(len(images), 2 + len(data["runs"]), f"{what}: number of images")
    for image in images:
        expect_equal(decoded_width(driver, image), data["width"], f"{what}: width of {image.get_attribute('alt')!r}")
        expect(image.get_attribute("alt"), f"{what}: an image has no alt text")
    left = scene.find_element(By.CSS_SELECTOR, ".slider .left")
    choices = scene.find_elements(By.CSS_SELECTOR, ".chooser")[0].find_elements(By.TAG_NAME, "option")
    expect_equal([choice.text for choice in choices], [*data["groups"][0]["labels"], "reference"], f"{what}: choices")
    for choice in reversed(choices):
        choice.click()
        expect_equal(decoded_width(driver, left), data["width"], f"{what}: width of the image of {choice.text!r}")


def slider_colours(frame):
    """Columns of the image under the slider that are red (a run's image) and blue (the reference's)."""
    picture = Image.open(io.BytesIO(frame.screenshot_as_png)).convert("RGB")
    row = [picture.getpixel((x, picture.height // 5)) for x in range(picture.width)]
    red = sum(1 for r, g, b in row if r > 200 and b < 100)
    blue = sum(1 for r, g, b in row if b > 200 and r < 100)
    return red / picture.width, blue / picture.width


def check_slider(driver, scene):
    frame = scene.find_element(By.CLASS_NAME, "slider")
    driver.execute_script("arguments[0].scrollIntoView({ block: 'center' })", frame)
    slider = frame.find_element(By.TAG_NAME, "input")
    width = frame.size["width"]
    for part in (0.5, 0.25, 0.8):
        if part != 0.5:
            drag = ActionChains(driver).move_to_element_with_offset(slider, 0, 0).click_and_hold()
            drag.move_to_element_with_offset(slider, round((part - 0.5) * width), 0).release().perform()
        red, blue = slider_colours(frame)
        # The divider is some pixels wide.
        expect(abs(red - part) < 0.02 and abs(blue - (1 - part)) < 0.02, f"slider at {part}: {red} red, {blue} blue")
    before = float(slider.get_property("value"))
    slider.send_keys(Keys.ARROW_LEFT)
    expect(float(slider.get_property("value")) < before, "slider by keyboard")
    choose = scene.find_elements(By.TAG_NAME, "select")[0]
    choose.find_elements(By.TAG_NAME, "option")[-1].click()
    expect_equal(slider_colours(frame)[0], 0, "red columns with the reference on both sides")


def check_region(driver, scene, data, region, what):
    scene.find_elements(By.CSS_SELECTOR, ".regions label")[region].click()
    check_time_chart(driver, scene, data, region, f"{what}, region {region}")
    check_memory_chart(driver, scene, data, region, f"{what}, region {region}")
    shown = [outline.is_displayed() for outline in scene.find_elements(By.CLASS_NAME, "outline")]
    expect_equal(shown, [region == 1], f"{what}: outline of region {region}")


def check_text(driver, results):
    """Users' names appear as they are, never as elements or code."""
    body = driver.find_element(By.TAG_NAME, "body").text
    for words in [results["command"], results["scenes"][0]["name"], *results["scenes"][0]["groups"][0]["labels"]]:
        expect(words in body, f"{words!r} is not on the page")
    expect_equal(driver.find_elements(By.CSS_SELECTOR, "main b, main i, main script"), [], "elements made of names")
    for scene in results["scenes"]:
        for summary in scene["summary"]["groups"][0]:
            expect(summary["text"] in body, f"the paragraph {summary['text']!r} is not on the page")


def check_alone(driver):
    for entry in driver.get_log("browser"):
        problems.append(f"console: {entry['message']}")
    for entry in driver.get_log("performance"):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            url = message["params"]["request"]["url"]
            expect(url.startswith("data:") or url.endswith("/report.html"), f"request of {url[:200]}")


def main():
    folder = os.path.abspath(sys.argv[1])
    with open(os.path.join(folder, "results.json"), encoding="utf-8") as file:
        results = json.load(file)
    driver = open_page(os.path.join(folder, "report.html"))
    try:
        scenes = driver.find_elements(By.CSS_SELECTOR, "section.scene")
        expect_equal(len(scenes), len(results["scenes"]), "number of scenes")
        for scene, data in zip(scenes, results["scenes"]):
            check_time_chart(driver, scene, data, 0, data["name"])
            check_memory_chart(driver, scene, data, 0, data["name"])
            check_colours(driver, scene, data["name"])
            check_images(driver, scene, data, data["name"])
        if not problems:
            check_drawing(driver, scenes[0])
            check_hover(driver, scenes[0], results["scenes"][0])
            check_tables(scenes[0], results["scenes"][0])
            check_legend(driver, scenes[0])
            check_slider(driver, scenes[0])
            for region in (1, 0):
                check_region(driver, scenes[0], results["scenes"][0], region, results["scenes"][0]["name"])
            check_text(driver, results)
        check_alone(driver)
    finally:
        driver.quit()
    print("\n".join(problems))
    return 1 if problems else 0


sys.exit(main())
