// The page: reads the results, which stand in it as JSON, and builds a section per scene.

// A scene and what its parts of the page share.
function sceneView(bench, images, scene) {
    const labels = scene.runs.map((run) => run.label);
    const view = { bench, images, scene, labels, styles: runStyles(scene) };
    view.summary = (group) => scene.summary.groups[scene.groups.indexOf(group)];
    // Per run of a group, its error at the group's equal time and what goes with it.
    view.results = (group, region) => {
        const { equal_time: time, errors, ranking, ahead_from: aheadFrom } = view.summary(group)[region];
        return group.runs.map((run, i) => {
            const curve = scene.summary.curves[run][region];
            const at = (values) => (time === null ? null : interpolate(curve.seconds, values, time, true));
            const [low, high] = [at(curve.low), at(curve.high)];
            return { run, curve, error: errors[i], low, high, best: ranking[0] === i, aheadFrom: aheadFrom[i] };
        });
    };
    view.bestRun = () => {
        const group = scene.groups[0];
        return group ? group.runs[view.summary(group)[0].ranking[0] ?? 0] : 0;
    };
    return view;
}

// The view in which runs are called what they are in a group: "65536 photons" rather than "tristimulus:20".
function groupView(view, group) {
    const labels = [...view.labels];
    group.runs.forEach((run, i) => (labels[run] = group.labels[i]));
    return { ...view, labels };
}

function legend(view, group, charts) {
    const buttons = group.runs.map((run, i) => {
        const button = element("button", { type: "button", "aria-pressed": "true" }, ...runName(view, run).childNodes);
        button.addEventListener("click", () => {
            const shown = button.getAttribute("aria-pressed") !== "true";
            button.setAttribute("aria-pressed", String(shown));
            for (const chart of charts()) {
                chart.setDatasetVisibility(i, shown);
                chart.update("none");
            }
        });
        return button;
    });
    return element("div", { class: "legend", role: "group", "aria-label": "Show or hide runs" }, ...buttons);
}

function chartFigure(kind, label) {
    const help = `${label}. Arrow keys walk over the points; the tables below hold the values.`;
    const canvas = element("canvas", { class: kind, role: "img", tabindex: 0, "aria-label": help });
    addKeyboard(canvas);
    const caption = element("figcaption", {});
    return { canvas, caption, figure: element("figure", {}, element("div", { class: "canvas" }, canvas), caption) };
}

function timeCaption(floor, shown) {
    if (!(floor > 0)) return "The reference has no estimate of its own error: small errors are to be read with care.";
    const text = `The reference’s own error, ${formatNumber(floor)}, `;
    if (!shown) return `${text}lies below this chart.`;
    return `${text}is dashed. Hollow points, within three times of it, hold a visible part of it.`;
}

function groupPart(view, group, id) {
    const { scene } = view;
    const findings = [...view.summary(group).map((summary) => summary.text), ...group.notes];
    const paragraphs = findings.map((text) => element("p", { class: "finding" }, text));
    const time = chartFigure("time", `${scene.name}, ${group.title}: error over time`);
    const memory = chartFigure("memory", `${scene.name}, ${group.title}: error over memory`);
    memory.caption.append("Left and low is better.");
    let charts = [];
    const tables = element("div");
    const part = element("section", { class: "group", id });
    if (scene.groups.length > 1) part.append(element("h3", {}, group.title));
    const legendRow = legend(view, group, () => charts);
    part.append(...paragraphs, legendRow, element("div", { class: "charts" }, time.figure, memory.figure), tables);
    const draw = (region) => {
        legendRow.querySelectorAll("button").forEach((button) => button.setAttribute("aria-pressed", "true"));
        const drawn = drawErrorOverTime(time.canvas, view, group, region);
        const over = drawErrorOverMemory(memory.canvas, view, group, region);
        charts = [drawn?.chart, over].filter((chart) => chart);
        time.figure.hidden = !drawn;
        memory.figure.hidden = !over;
        time.caption.textContent = timeCaption(scene.reference.floor[region], drawn?.floorShown);
        const made = [runsTable(view, group, region), timesTable(view, group, region), memoryTable(view, group)];
        tables.replaceChildren(...made.filter((one) => one !== null));
    };
    return { part, draw };
}

function regionChooser(view, onChange) {
    if (view.scene.regions.length < 2) return null;
    const buttons = view.scene.regions.map((_, i) => {
        const name = `region-${view.scene.name}`;
        const input = element("input", { type: "radio", name, value: i, checked: i === 0 });
        input.addEventListener("change", () => onChange(i));
        return element("label", {}, input, element("span", {}, regionName(view.scene, i)));
    });
    return element("fieldset", { class: "regions" }, element("legend", {}, "Error measured in"), ...buttons);
}

function referenceText(view) {
    const { reference } = view.scene;
    const { file, method, seed, seconds, passes } = reference;
    const effort = `${formatSeconds(seconds)} (${formatCount(passes)} passes)`;
    return (
        `Errors are differences from ${file}, rendered by ${method} with seed ${seed} in ${effort}. Its own error, ` +
        "the floor, is its noise and the estimate of its bias together: errors measured below it mean nothing, and " +
        "curves within three times of it are marked."
    );
}

function groupId(scene, group) {
    return `scene-${scene}-${group.name}`;
}

function scenePart(bench, images, errorMap, scene, index) {
    const view = sceneView(bench, images, scene);
    const groups = scene.groups.map((group) => groupPart(groupView(view, group), group, groupId(index, group)));
    const part = element("section", { class: "scene", id: `scene-${index}` });
    const select = (region) => {
        groups.forEach((group) => group.draw(region));
        for (const outline of part.querySelectorAll(".outline")) {
            outline.hidden = Number(outline.dataset.region) !== region;
        }
    };
    const slider = imageSlider(view);
    const maps = errorMaps(view, errorMap);
    part.append(
        element("h2", {}, scene.name),
        element("p", { class: "muted" }, `${scene.file} · ${scene.width} × ${scene.height} pixels`),
        ...[regionChooser(view, select)].filter((one) => one),
        ...groups.map((group) => group.part)
    );
    if (slider) part.append(element("h3", {}, "Images at equal time"), slider);
    if (maps) part.append(element("h3", {}, "Error at equal time, in XYZ"), maps);
    part.append(element("h3", {}, "Reference"), element("p", {}, referenceText(view)), referenceTable(view));
    part.append(element("details", {}, element("summary", {}, "Settings"), optionsTable(view)));
    return { view, part, select };
}

// Each comparison's outcome over the whole image: the first sentence of its paragraph.
function overview(bench, views) {
    const entries = views.flatMap((view, i) =>
        view.scene.groups.map((group) => {
            const names = [];
            if (views.length > 1) names.push(view.scene.name);
            if (view.scene.groups.length > 1) names.push(group.title);
            const link = element("a", { href: `#${groupId(i, group)}` }, names.join(": "));
            return [link, view.summary(group)[0].text.split(/(?<=\.) /)[0]];
        })
    );
    return entries.length < 2 ? null : element("nav", { "aria-label": "Comparisons" }, facts(entries));
}

function main() {
    const { results: bench, images, errorMap } = JSON.parse(document.getElementById("data").textContent);
    const page = document.getElementById("report");
    const names = bench.scenes.map((scene) => scene.name);
    const title = bench.kind === "costs" ? "What accuracy costs" : "What accuracy costs in time";
    document.title = `${title}: ${names.join(", ")}`;
    const devices = bench.devices.map((device) => device.name).join(", ");
    const effort = `${formatSeconds(bench.seconds)} of rendering, ${bench.repeats} × per run, on ${devices}`;
    page.replaceChildren(element("h1", {}, title), element("p", { class: "muted" }, effort));
    const missing = unfinished(bench);
    if (missing > 0) {
        const note = "of the renders are not finished: what follows rests on what they have measured so far.";
        page.append(element("p", { role: "note" }, `${missing} ${note}`));
    }
    const scenes = bench.scenes.map((scene, i) => scenePart(bench, images, errorMap, scene, i));
    const glance = overview(bench, scenes.map((scene) => scene.view));
    if (glance) page.append(glance);
    page.append(...scenes.map((scene) => scene.part));
    const files = element("p", { class: "muted" }, "All values: results.json and results.csv beside this page.");
    page.append(element("footer", {}, element("h2", {}, "Bench"), benchFacts(bench), files));
    Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
    scenes.forEach((scene) => scene.select(0));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", refreshTheme);
    matchMedia("print").addEventListener("change", refreshTheme);
}

main();
