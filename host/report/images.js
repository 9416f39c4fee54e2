// Images: one against another under a slider, and the error maps.

function imageChoices(view) {
    const runs = view.scene.runs.map((run, i) => ({ name: view.labels[i], file: run.image }));
    return [...runs, { name: "reference", file: view.scene.image }].filter((choice) => choice.file);
}

function chooser(label, choices, chosen, onChange) {
    const options = choices.map((choice, i) => element("option", { value: i, selected: i === chosen }, choice.name));
    const select = element("select", {}, ...options);
    select.addEventListener("change", () => onChange(choices[Number(select.value)]));
    return element("label", { class: "chooser" }, label, select);
}

// Two images in one frame: left of the divider the first, right of it the second.
function imageSlider(view) {
    const choices = imageChoices(view);
    if (choices.length < 2) return null;
    const images = [0, 1].map((side) => element("img", { class: side === 0 ? "left" : "right", draggable: "false" }));
    const show = (side) => (choice) => {
        images[side].src = view.images[choice.file];
        images[side].alt = `${view.scene.name}, ${choice.name}`;
    };
    const label = "Divider between the images, from left to right";
    const range = element("input", { type: "range", min: 0, max: 100, step: 0.5, value: 50, "aria-label": label });
    const outlines = view.scene.regions.slice(1).map((region, i) => regionOutline(view.scene, i + 1));
    const divider = element("span", { class: "divider" });
    const frame = element("div", { class: "slider" }, images[1], images[0], ...outlines, divider, range);
    range.addEventListener("input", () => frame.style.setProperty("--split", `${range.value}%`));
    frame.style.setProperty("--split", "50%");
    frame.style.maxWidth = `${Math.max(view.scene.width, 560)}px`;
    const last = choices.length - 1;
    const best = choices.findIndex((choice) => choice.file === view.scene.runs[view.bestRun()].image);
    const first = Math.max(best, 0);
    show(0)(choices[first]);
    show(1)(choices[last]);
    const choosers = [chooser("Left", choices, first, show(0)), chooser("Right", choices, last, show(1))];
    return element("figure", {}, element("div", { class: "choosers" }, ...choosers), frame);
}

// Where a region lies in the images, which show the first region alone. Shown while the region is selected.
function regionOutline(scene, index) {
    const [x0, y0, x1, y1] = scene.regions[0].region;
    const [a, b, c, d] = scene.regions[index].region;
    const across = (pixels) => `${(100 * pixels) / (x1 - x0)}%`;
    const down = (pixels) => `${(100 * pixels) / (y1 - y0)}%`;
    const style = `left: ${across(a - x0)}; top: ${down(b - y0)}; width: ${across(c - a)}; height: ${down(d - b)}`;
    return element("span", { class: "outline", "data-region": index, style, hidden: true });
}

// Every run's error map, and the scale that they share.
function errorMaps(view, scaleBar) {
    const { scene } = view;
    const maps = scene.runs.map((run, i) => ({ run, i })).filter(({ run }) => run.error_map);
    if (maps.length === 0) return null;
    const figures = maps.map(({ run, i }) =>
        element(
            "figure", {},
            element("img", { src: view.images[run.error_map], alt: `Error map of ${view.labels[i]} in ${scene.name}` }),
            element("figcaption", {}, runName(view, i))
        )
    );
    const ticks = [];
    for (let decade = scaleBar.decades; decade >= 0; decade -= 1) {
        ticks.push(element("span", {}, formatRound(scene.error_map_scale / 10 ** decade)));
    }
    const bar = element("div", {
        class: "scale-bar",
        style: `background: linear-gradient(to right, ${scaleBar.colours.join(", ")})`,
        role: "img",
        "aria-label": "Colours from the least to the greatest error",
    });
    const scale = element("div", { class: "scale" }, bar, element("div", { class: "ticks" }, ...ticks));
    return element("div", {}, element("div", { class: "maps" }, ...figures), scale);
}
