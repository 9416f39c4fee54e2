// The charts: error over time, error over memory. Both axes are logarithmic.

// Colours stand in report.css, so that they follow the reader's light or dark scheme.
const RUN_COLOURS = 8;
const DASHES = [[], [7, 4], [7, 3, 2, 3], [2, 3]];
const POINTS = [
    ["circle", 0],
    ["rect", 0],
    ["triangle", 0],
    ["rectRot", 0],
    ["triangle", 180],
    ["rectRounded", 0],
    ["triangle", 90],
    ["triangle", 270],
]; // shape and rotation in degrees
const MIB = 1024 * 1024;

function cssColour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}

// One style per run, the same in all charts of a scene, and no two alike within a group: each run takes the first
// style that is free in every group it is part of.
function runStyles(scene) {
    const styles = new Array(scene.runs.length).fill(null);
    for (const group of scene.groups) {
        for (const run of group.runs) {
            if (styles[run] !== null) continue;
            const beside = scene.groups.filter((other) => other.runs.includes(run)).flatMap((other) => other.runs);
            const taken = beside.map((other) => styles[other]);
            styles[run] = 0;
            while (taken.includes(styles[run])) styles[run] += 1;
        }
    }
    return styles.map((style) => style ?? 0);
}

// A dataset's part of a run's style.
function lineStyle(style) {
    const [pointStyle, pointRotation] = POINTS[style % POINTS.length];
    return { style, pointStyle, pointRotation, borderDash: DASHES[Math.floor(style / RUN_COLOURS) % DASHES.length] };
}

function styleColour(style) {
    return `--run-${style % RUN_COLOURS}`;
}

// Draws, under the curves, each one's spread, and what lies below three times the reference's floor.
const spreadAndFloor = {
    id: "spreadAndFloor",
    beforeDatasetsDraw(chart) {
        const { ctx, chartArea: area, scales } = chart;
        ctx.save();
        ctx.beginPath();
        ctx.rect(area.left, area.top, area.width, area.height);
        ctx.clip();
        const floor = chart.options.plugins.spreadAndFloor.floor;
        if (floor > 0) {
            const top = scales.y.getPixelForValue(3 * floor);
            ctx.fillStyle = cssColour("--floor");
            ctx.fillRect(area.left, top, area.width, Math.max(0, area.bottom - top));
            ctx.strokeStyle = cssColour("--ink");
            ctx.setLineDash([6, 4]);
            const line = scales.y.getPixelForValue(floor);
            ctx.beginPath();
            ctx.moveTo(area.left, line);
            ctx.lineTo(area.right, line);
            ctx.stroke();
        }
        chart.data.datasets.forEach((dataset, i) => {
            if (!chart.isDatasetVisible(i) || !dataset.spread) return;
            const xs = dataset.data.map((point) => scales.x.getPixelForValue(point.x));
            const edge = (errors) => errors.map((error, k) => [xs[k], scales.y.getPixelForValue(error)]);
            const outline = [...edge(dataset.spread.low), ...edge(dataset.spread.high).reverse()];
            ctx.beginPath();
            outline.forEach(([x, y]) => ctx.lineTo(x, y));
            ctx.globalAlpha = 0.18;
            ctx.fillStyle = dataset.borderColor;
            ctx.fill();
            ctx.globalAlpha = 1;
        });
        ctx.restore();
    },
};

// Round values from low to high: 1, 10, 100, … over many decades, 1, 2, 5, 10, … over some, equal steps within one.
function logTicks(low, high) {
    const decades = Math.log10(high / low);
    const ticks = [];
    if (decades > 0.8) {
        const mantissas = decades > 2.5 ? [1] : [1, 2, 5];
        for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
            ticks.push(...mantissas.map((mantissa) => Number(`${mantissa}e${power}`)));
        }
    } else {
        const power = 10 ** Math.floor(Math.log10((high - low) / 3));
        const step = [5, 2, 1].map((mantissa) => mantissa * power).find((size) => (high - low) / size >= 3);
        for (let k = Math.ceil(low / step); k * step <= high; k += 1) ticks.push(Number((k * step).toPrecision(6)));
    }
    return ticks.filter((value) => value >= low && value <= high);
}

// Room around positive values on a logarithmic axis.
function logAxis(title, values) {
    const least = Math.min(...values);
    const greatest = Math.max(...values);
    const margin = Math.max((greatest / least) ** 0.05, 1.1);
    const [min, max] = [least / margin, greatest * margin];
    return {
        type: "logarithmic",
        min,
        max,
        title: { display: true, text: title },
        afterBuildTicks: (axis) => (axis.ticks = logTicks(min, max).map((value) => ({ value }))),
        ticks: { callback: (value) => formatRound(value), autoSkip: false, maxRotation: 0 },
    };
}

function applyTheme(chart) {
    const muted = cssColour("--muted");
    const rule = cssColour("--rule");
    for (const axis of Object.values(chart.options.scales)) {
        axis.title.color = muted;
        axis.ticks.color = muted;
        axis.grid = { color: rule, borderColor: rule, tickLength: 4 };
    }
    chart.options.plugins.tooltip.borderColor = muted;
    for (const dataset of chart.data.datasets) {
        const colour = cssColour(styleColour(dataset.style));
        dataset.borderColor = colour;
        dataset.pointBorderColor = colour;
        const fill = colour + dataset.opacity;
        dataset.pointBackgroundColor = dataset.hollow.map((hollow) => (hollow ? cssColour("--surface") : fill));
    }
}

function refreshTheme() {
    for (const chart of Object.values(Chart.instances)) {
        applyTheme(chart);
        chart.update("none");
    }
}

// Arrow keys walk over a focused chart's points: left and right along a curve, up and down from curve to curve.
function addKeyboard(canvas) {
    const at = { datasetIndex: 0, index: -1 };
    const show = (elements) => {
        const chart = Chart.getChart(canvas);
        chart.setActiveElements(elements);
        chart.tooltip.setActiveElements(elements, { x: 0, y: 0 });
        chart.update("none");
    };
    canvas.addEventListener("keydown", (event) => {
        const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
        const step = steps[event.key];
        const datasets = Chart.getChart(canvas).data.datasets;
        if (!step || datasets.length === 0) return;
        event.preventDefault();
        at.datasetIndex = Math.min(Math.max(at.datasetIndex + step[1], 0), datasets.length - 1);
        at.index = Math.min(Math.max(at.index + step[0], 0), datasets[at.datasetIndex].data.length - 1);
        show([{ ...at }]);
    });
    canvas.addEventListener("blur", () => show([]));
}

// A chart on a canvas. `tooltip(dataset, index)` gives its first line and the lines below.
function drawChart(canvas, datasets, scales, floor, tooltip) {
    const old = Chart.getChart(canvas);
    if (old) old.destroy();
    const chart = new Chart(canvas, {
        type: "line",
        data: { datasets },
        plugins: [spreadAndFloor],
        options: {
            animation: false,
            maintainAspectRatio: false,
            interaction: { mode: "nearest", intersect: false },
            elements: { line: { borderWidth: 2 }, point: { radius: 3, hoverRadius: 6, borderWidth: 1.5 } },
            scales,
            plugins: {
                legend: { display: false },
                spreadAndFloor: { floor },
                tooltip: {
                    displayColors: false,
                    padding: 10,
                    borderWidth: 1,
                    callbacks: {
                        title: (items) => (items.length > 0 ? tooltip(items[0].dataset, items[0].dataIndex)[0] : ""),
                        label: (item) => tooltip(item.dataset, item.dataIndex)[1],
                    },
                },
            },
        },
    });
    applyTheme(chart);
    chart.update("none");
    return chart;
}

function spreadText(low, high) {
    return `spread ${formatNumber(low)} – ${formatNumber(high)}`;
}

// What a repeat's checkpoints say of a time; passes grow in step with time.
function atTime(run, seconds, member, log) {
    return median(
        run.repeats.map((repeat) => {
            const times = repeat.checkpoints.map((checkpoint) => checkpoint.seconds);
            const values = repeat.checkpoints.map(member);
            const usable = times.map((_, i) => i).filter((i) => values[i] !== null && values[i] !== undefined);
            return interpolate(usable.map((i) => times[i]), usable.map((i) => values[i]), seconds, log);
        })
    );
}

// Error over time of a group's runs in a region.
function drawErrorOverTime(canvas, view, group, region) {
    const { scene } = view;
    const curves = group.runs.map((run) => scene.summary.curves[run][region]);
    const datasets = group.runs.map((run, i) => ({
        label: view.labels[run],
        run,
        ...lineStyle(view.styles[run]),
        data: curves[i].seconds.map((x, k) => ({ x, y: curves[i].median[k] })),
        spread: scene.runs[run].repeats.length > 1 ? { low: curves[i].low, high: curves[i].high } : null,
        opacity: "",
        hollow: curves[i].seconds.map((x) => curves[i].near_floor_from !== null && x >= curves[i].near_floor_from),
    }));
    const positive = (values) => values.filter((value) => value > 0);
    const seconds = positive(curves.flatMap((curve) => curve.seconds));
    const errors = positive(curves.flatMap((curve) => [...curve.median, ...curve.low, ...curve.high]));
    if (seconds.length === 0 || errors.length === 0) return null;
    const floor = scene.reference.floor[region];
    // A floor far below would press the curves together.
    const shown = floor > 0 && 30 * floor > Math.min(...errors) ? [floor] : [];
    const scales = {
        x: logAxis("Seconds of rendering", seconds),
        y: logAxis("RMSE in XYZ", [...errors, ...shown]),
    };
    const chart = drawChart(canvas, datasets, scales, floor, (dataset, k) => {
        const run = scene.runs[dataset.run];
        const { x, y } = dataset.data[k];
        const lines = [`${formatSeconds(x)}: RMSE ${formatNumber(y)}`];
        if (dataset.spread) lines.push(spreadText(dataset.spread.low[k], dataset.spread.high[k]));
        lines.push(`relMSE ${formatNumber(atTime(run, x, (checkpoint) => checkpoint.rel_mse[region], true))}`);
        lines.push(`${formatCount(atTime(run, x, (checkpoint) => checkpoint.passes, false))} passes`);
        if (dataset.hollow[k]) lines.push("within 3 × the reference's floor");
        return [dataset.label, lines];
    });
    return { chart, floorShown: shown.length > 0 };
}

function peakMemory(run) {
    return Math.max(0, ...run.repeats.flatMap((repeat) => repeat.checkpoints.map((checkpoint) => checkpoint.memory)));
}

// Error at equal time over memory, one point per run.
function drawErrorOverMemory(canvas, view, group, region) {
    const results = view.results(group, region);
    const points = results.filter((result) => result.error > 0 && peakMemory(view.scene.runs[result.run]) > 0);
    if (points.length === 0) return null;
    const datasets = results.map(({ run, error, low, high }) => ({
        label: view.labels[run],
        run,
        ...lineStyle(view.styles[run]),
        data: error > 0 ? [{ x: peakMemory(view.scene.runs[run]) / MIB, y: error }] : [],
        error: { low, high },
        hollow: [false],
        opacity: "99", // of points that may lie upon one another
        pointRadius: 6,
        pointHoverRadius: 8,
    }));
    const scales = {
        x: logAxis("Device memory in MiB", points.map(({ run }) => peakMemory(view.scene.runs[run]) / MIB)),
        y: logAxis("RMSE at equal time", points.map(({ error }) => error)),
    };
    return drawChart(canvas, datasets, scales, 0, (dataset) => {
        const { x, y } = dataset.data[0];
        const lines = [`${formatBytes(x * MIB)}: RMSE ${formatNumber(y)}`];
        if (dataset.error.low !== dataset.error.high) lines.push(spreadText(dataset.error.low, dataset.error.high));
        return [dataset.label, lines];
    });
}
