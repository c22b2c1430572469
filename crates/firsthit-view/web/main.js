// @ts-check
// The page: a picture that is looked at, and questions about it.

import { OrbitCamera, unit } from "./camera.js";
import { Chapter } from "./chapter.js";
import { colored, rangeOf } from "./color.js";
import { Compare } from "./compare.js";
import { CutPlane } from "./cut.js";
import { download, element, make, offer, six, vector, words } from "./dom.js";
import { NativeEngine } from "./engine-native.js";
import { hear } from "./hear.js";
import { hold } from "./hands.js";
import { LightBall } from "./light-ball.js";
import { Marks } from "./marks.js";
import { Objects } from "./objects.js";
import { inLines } from "./story.js";
import { View } from "./view.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine-native.js").Look} Look */
/** @typedef {import("./engine-native.js").Painted} Painted */

/** Channels whose numbers are not shown by a map of colours. */
const KINDS = /** @type {Record<string, "identifier" | "flag" | "direction" | "number">} */ ({
    object: "identifier", primitive: "identifier", front: "flag", normal: "direction", position: "direction",
});
const SUN = "a sun: the ball";

const [engine, saver] = [new NativeEngine(), new NativeEngine()];
/** An error stays for so long, in milliseconds, though pictures go on coming. */
const HELD = 5_000;
let heldUntil = 0;
const say = (/** @type {string} */ text, /** @type {boolean} */ isError) => {
    if (!isError && performance.now() < heldUntil) return;
    if (isError) heldUntil = performance.now() + HELD;
    element("message").textContent = text;
    element("message").classList.toggle("error", isError);
    if (isError) element("announcement").textContent = text;
};

try {
    begin(await engine.info());
} catch (error) {
    say(words(error), true);
}

/** @param {any} info */
function begin(info) {
    introduce(info);
    const camera = new OrbitCamera(info.camera, info.up, info.bounds);
    const [picture, overlay, stage] = [element("picture"), element("overlay"), element("stage")];
    const drawing = picture.getContext("2d", { willReadFrequently: true });
    offer("channel", info.channels.map((/** @type {any} */ channel) => channel.name));
    offer("map", Object.keys(info.maps));
    offer("light", ["as rendered", SUN, ...info.lights]);
    element("map").value = "viridis";
    element("edges").checked = info.edges !== null;
    element("orthographic").checked = camera.projection === "orthographic";

    const marks = new Marks(info.title, draw, say);
    const objects = new Objects(info, moved);
    const cut = new CutPlane(info.bounds, () => camera.aim, moved);
    const axes = () => ({ right: camera.axes()[0], up: camera.axes()[1], aim: unit(camera.aim) });
    const ball = new LightBall(axes, () => {
        element("light").value = SUN;
        moved();
    });
    const part = () => ({ ...objects.asked(), cut: cut.plane() });
    const chapter = new Chapter(info, camera, new NativeEngine(), part, moved);
    /** What the picture shows now. @type {import("./compare.js").Shown | null} */
    let shown = null;
    const compare = new Compare(() => shown);

    const sight = (/** @type {number} */ rows, /** @type {number} */ columns) => (chapter.isOpen ? chapter.sight() : camera.sight(rows, columns));
    /** @returns {Look} */
    const look = (/** @type {number} */ rows, /** @type {number} */ columns) => {
        const light = element("light").value;
        return {
            camera: sight(rows, columns),
            channel: element("channel").value,
            samples: 1,
            is_lit: false,
            light: info.lights.includes(light) ? light : null,
            sun: light === SUN ? ball.direction : null,
            ground: [null, true, false][element("ground").selectedIndex],
            // Edges are those of whole surfaces.
            edges: cut.plane() ? 0 : element("edges").checked ? (info.edges ?? 1.5) : 0,
            part: part(),
        };
    };
    const view = new View(engine, look, paint, say, () => {
        // What is under the pointer may be something else by now.
        if (lastPixel) point(lastPixel);
        element("announcement").textContent = element("message").textContent;
    });

    /** @param {Painted} painted @param {Look} asked */
    function paint(painted, asked) {
        const { rows, columns, components } = painted.about;
        if (picture.width !== columns || picture.height !== rows) [picture.width, picture.height] = [columns, rows];
        element("bar").hidden = true;
        if (painted.image) {
            drawing.clearRect(0, 0, columns, rows);
            drawing.drawImage(painted.image, 0, 0);
            painted.image.close();
        } else if (painted.values && components) {
            const kind = KINDS[asked.channel] ?? "number";
            const found = kind === "number" ? rangeOf(painted.values) : null;
            const range = chosenRange() ?? found;
            const map = info.maps[element("map").value];
            const values = asked.channel === "position" ? spread(painted.values) : painted.values;
            const pixels = colored(values, components, { kind, map, range });
            drawing.putImageData(new ImageData(/** @type {any} */ (pixels), columns, rows), 0, 0);
            if (kind === "number" && range) showBar(map, range);
            lastRange = range;
        }
        const [whole] = view.shape;
        shown = whole === rows ? { rows, columns, pixels: drawing.getImageData(0, 0, columns, rows).data, values: painted.values ?? null, name: asked.channel } : null;
        document.body.dataset.painted = `${columns}x${rows}`;
        compare.draw();
        draw();
    }

    /** Positions, each axis from -1 to 1. @param {Float32Array | Int32Array} values */
    function spread(values) {
        const [low, high] = info.bounds ?? [[0, 0, 0], [1, 1, 1]];
        return Float32Array.from(values, (x, k) => (2 * (x - low[k % 3])) / (high[k % 3] - low[k % 3] || 1) - 1);
    }

    /** The range of the numbers that are shown. @type {[number, number] | null} */
    let lastRange = null;

    /** @param {number[][]} map @param {[number, number]} range */
    function showBar(map, range) {
        const canvas = element("bar-map");
        canvas.width = map.length;
        const bar = canvas.getContext("2d");
        const pixels = bar.createImageData(map.length, 1);
        map.forEach((color, k) => pixels.data.set([...color, 255], 4 * k));
        bar.putImageData(pixels, 0, 0);
        [element("bar-low").textContent, element("bar-high").textContent] = range.map(six);
        element("bar").hidden = false;
    }

    /** The range that was typed, if it is one. @returns {[number, number] | null} */
    function chosenRange() {
        const [low, high] = ["low", "high"].map((id) => element(id).value.trim());
        const isEmpty = low === "" && high === "";
        const isRange = low !== "" && high !== "" && Number(low) < Number(high);
        for (const id of ["low", "high"]) element(id).setAttribute("aria-invalid", String(!isEmpty && !isRange));
        return isRange ? [Number(low), Number(high)] : null;
    }

    /** Marks, over the picture. */
    function draw() {
        const scale = devicePixelRatio;
        const [rows, columns] = [overlay.clientHeight, overlay.clientWidth];
        [overlay.width, overlay.height] = [Math.round(scale * columns), Math.round(scale * rows)];
        const on = overlay.getContext("2d");
        on.scale(scale, scale);
        marks.draw(on, (point) => camera.pixelOf(point, rows, columns));
        if (chapter.isOpen) chapter.frameFollowed(on, rows, columns);
    }

    /** Something is to be seen otherwise. */
    function moved() {
        chapter.moved();
        view.fixed = chapter.isOpen ? [chapter.sight().rows, chapter.sight().columns] : null;
        element("edges").disabled = cut.plane() !== null;
        place();
        view.moved();
        tellCamera();
    }

    /** Where the picture lies on the stage: all over it, but for the chapter's, which has a shape of its own. */
    function place() {
        const [wide, high] = [stage.clientWidth, stage.clientHeight];
        let [width, height] = [wide, high];
        if (chapter.isOpen) {
            const { width: w, height: h } = chapter.sight();
            const fit = Math.min(wide / w, high / h);
            [width, height] = [w * fit, h * fit];
        }
        picture.classList.toggle("pixels", chapter.isOpen);
        for (const canvas of [picture, overlay, element("before")]) {
            Object.assign(canvas.style, { left: `${(wide - width) / 2}px`, top: `${(high - height) / 2}px`, width: `${width}px`, height: `${height}px` });
        }
        draw();
    }

    const tellCamera = newest(async () => {
        const said = await engine.say(sight(...view.shape));
        const wanted = said[element("say-as").value];
        const text = typeof wanted === "string" ? wanted : JSON.stringify(wanted);
        element("said").textContent = wanted === null ? "Parallel rays have no matrix of pixels." : text;
    });

    // Pointing.
    /** @type {any} */
    let pointed = null;
    /** @type {[number, number] | null} */
    let lastPixel = null;
    /** @param {PointerEvent} event @returns {[number, number]} */
    function pixelAt(event) {
        const box = picture.getBoundingClientRect();
        const [rows, columns] = view.shape;
        const column = Math.floor(((event.clientX - box.left) / box.width) * columns);
        const row = Math.floor(((event.clientY - box.top) / box.height) * rows);
        return [Math.max(0, Math.min(columns - 1, column)), Math.max(0, Math.min(rows - 1, row))];
    }
    const point = newest(async (/** @type {[number, number]} */ asked) => {
        lastPixel = asked;
        const [rows, columns] = view.shape;
        if (asked[0] >= columns || asked[1] >= rows) return;
        const { text, ...story } = await engine.probe(sight(...view.shape), asked, part());
        pointed = story;
        element("probe").textContent = inLines(story);
        element("probe").title = text;
        element("copy-probe").disabled = false;
        objects.point(story.hit ? story.hit.object : null);
        if (chapter.isOpen) {
            chapter.follow(asked, story, colorAt(asked));
            draw();
        }
        document.body.dataset.probed = asked.join(",");
    });
    /** The colour that is shown there. @param {[number, number]} pixel */
    const colorAt = ([column, row]) => [...drawing.getImageData(column, row, 1, 1).data];
    /** @param {[number, number]} pixel */
    async function keep(pixel) {
        try {
            const story = await engine.probe(sight(...view.shape), pixel, part());
            if (story.hit) marks.add(story.hit);
        } catch (error) {
            say(words(error), true);
        }
    }

    // The mouse, fingers and keys.
    const aspect = () => view.columns / view.rows;
    /** The standard views but for the one that all begins with. @type {{name: string, aim: Vector, up: Vector}[]} */
    const views = info.views.filter((/** @type {any} */ one) => one.name !== "iso");
    for (const one of views) {
        const button = make("button", one.name);
        button.addEventListener("click", () => lookAlong(one));
        element("views").append(button);
    }
    /** @param {{aim: Vector, up: Vector}} one */
    function lookAlong({ aim, up }) {
        camera.lookAlong(aim, up, aspect());
        moved();
    }
    /** The step of the turntable that comes next; 0 where it stands. */
    let turning = 0;
    function turn() {
        const step = () => {
            camera.orbit(-0.015, 0);
            moved();
            turning = requestAnimationFrame(step);
        };
        if (turning) {
            cancelAnimationFrame(turning);
            turning = 0;
        } else {
            step();
        }
        element("turn").setAttribute("aria-pressed", String(turning !== 0));
    }
    function project() {
        camera.project(element("orthographic").checked ? "orthographic" : "perspective");
        moved();
    }
    function chosen() {
        const isNumber = element("channel").value !== "color" && !KINDS[element("channel").value];
        element("map-label").hidden = element("range-label").hidden = !isNumber;
        moved();
    }
    const press = (/** @type {string} */ id) => () => element(id).click();
    hold(picture, camera, { moved, point: (event) => point(pixelAt(event)), keep: (event) => keep(pixelAt(event)) });
    /** @type {Record<string, {about: string, act: () => void}>} */
    const keys = {
        f: { about: "all in the picture", act: press("frame") },
        0: { about: "as at the beginning", act: () => {
            camera.reset();
            element("orthographic").checked = camera.projection === "orthographic";
            moved();
        } },
        o: { about: "orthographic or perspective", act: press("orthographic") },
        g: { about: "ground: as rendered, with, without", act: () => {
            const list = element("ground");
            list.selectedIndex = (list.selectedIndex + 1) % 3;
            moved();
        } },
        e: { about: "edges", act: press("edges") },
        t: { about: "turn by itself", act: turn },
        c: { about: "next channel", act: () => {
            const list = element("channel");
            list.selectedIndex = (list.selectedIndex + 1) % list.options.length;
            list.dispatchEvent(new Event("change"));
        } },
        h: { about: "hide the object under the pointer", act: () => {
            if (pointed?.hit) objects.show((object) => object !== pointed.hit.object && !objects.hidden.has(object));
        } },
        u: { about: "undo the last mark", act: press("undo") },
        Escape: { about: "clear marks", act: press("clear") },
        Enter: { about: "keep the point in the picture's middle", act: () => {
            const [rows, columns] = view.shape;
            /** @type {[number, number]} */
            const middle = [columns >> 1, rows >> 1];
            point(middle);
            keep(middle);
        } },
        "?": { about: "this list", act: press("help") },
    };
    views.forEach((one, k) => (keys[k + 1] = { about: `${one.name} view`, act: () => lookAlong(one) }));
    listKeys(keys);
    addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || element("keys").open) return;
        const target = /** @type {HTMLElement} */ (event.target);
        const isArrow = event.key.startsWith("Arrow");
        const isTyping = target instanceof HTMLInputElement && !(target.type === "checkbox" || (target.type === "range" && !isArrow));
        if (isTyping || ["SELECT", "TEXTAREA"].includes(target.tagName)) return;
        const isAtControl = ["BUTTON", "SUMMARY"].includes(target.tagName);
        if (isAtControl && (event.key === "Enter" || event.key === " ")) return;
        const arrow = /** @type {Record<string, number[]>} */ ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] })[event.key];
        const nearer = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[event.key];
        const key = keys[event.key] ?? keys[event.key.toLowerCase()];
        if (arrow) {
            if (event.shiftKey) camera.pan(-0.05 * arrow[0], 0.05 * arrow[1]);
            else camera.orbit(-0.1 * arrow[0], -0.1 * arrow[1]);
            moved();
        } else if (nearer) {
            camera.zoom(nearer, 0, 0);
            moved();
        } else if (key) {
            key.act();
        } else {
            return;
        }
        event.preventDefault();
    });

    // The panel.
    element("channel").addEventListener("change", () => {
        // A range is of one channel.
        for (const id of ["low", "high"]) element(id).value = "";
        chosen();
    });
    for (const id of ["map", "low", "high"]) element(id).addEventListener("change", chosen);
    for (const id of ["ground", "edges"]) element(id).addEventListener("change", moved);
    element("light").addEventListener("change", () => {
        if (element("light").value === SUN) ball.shine();
        else ball.clear();
        moved();
    });
    element("orthographic").addEventListener("change", project);
    element("fix-range").addEventListener("click", () => {
        if (lastRange) [element("low").value, element("high").value] = lastRange.map(String);
        chosen();
    });
    element("frame").addEventListener("click", () => {
        camera.frame(aspect());
        moved();
    });
    element("turn").addEventListener("click", turn);
    element("help").addEventListener("click", () => element("keys").showModal());
    element("close-keys").addEventListener("click", () => element("keys").close());
    element("say-as").addEventListener("change", tellCamera);
    element("copy-probe").addEventListener("click", () => copy(JSON.stringify(pointed, null, 2)));
    element("copy-camera").addEventListener("click", () => copy(element("said").textContent));
    element("take-camera").addEventListener("click", async () => {
        try {
            const [rows, columns] = view.shape;
            const heard = hear(element("heard").value, rows, columns, info.up);
            // The engine refuses what is no camera.
            await engine.say(heard);
            camera.take(heard);
            if (chapter.isOpen) chapter.take(heard);
            element("orthographic").checked = camera.projection === "orthographic";
            moved();
        } catch (error) {
            say(words(error), true);
        }
    });
    element("save-shown").addEventListener("click", () => picture.toBlob((/** @type {Blob} */ blob) => download("view.png", blob)));
    element("save-rendered").addEventListener("click", async () => {
        try {
            const whole = { ...look(...view.shape), samples: null, is_lit: true, channel: "color" };
            // It has an engine of its own: a frame that is asked for meanwhile does not end it.
            const { blob } = view.full ?? (await saver.frame(whole, new AbortController().signal));
            if (blob) download("render.png", blob);
        } catch (error) {
            say(words(error), true);
        }
    });
    async function copy(/** @type {string} */ text) {
        try {
            await navigator.clipboard.writeText(text);
            say("Copied.", false);
        } catch {
            say("The browser did not let the page copy: mark the text and copy it.", true);
        }
    }

    new ResizeObserver(() => {
        const scale = devicePixelRatio;
        const [rows, columns] = [stage.clientHeight, stage.clientWidth].map((edge) => Math.max(1, Math.round(edge * scale)));
        place();
        view.resize(rows, columns);
        tellCamera();
    }).observe(stage);
    const stay = async () => {
        try {
            await engine.alive();
        } catch (error) {
            say(words(error), true);
        }
    };
    setInterval(stay, 5_000);
    marks.restore();
    document.body.dataset.ready = "yes";
}

/** Does something for the newest of many calls: one at a time, and of those that wait the last. @template {any[]} T @param {(...given: T) => Promise<void>} act @returns {(...given: T) => Promise<void>} */
function newest(act) {
    /** @type {T | null} */
    let next = null;
    let isAtIt = false;
    return async (...given) => {
        next = given;
        if (isAtIt) return;
        isAtIt = true;
        while (next) {
            const now = next;
            next = null;
            try {
                await act(...now);
            } catch (error) {
                say(words(error), true);
            }
        }
        isAtIt = false;
    };
}

/** Title, counts and warnings. @param {any} info */
function introduce(info) {
    element("title").textContent = info.title;
    document.title = `${info.title} - firsthit`;
    const count = (/** @type {number} */ n, /** @type {string} */ noun) => `${n.toLocaleString("en")} ${noun}${n === 1 ? "" : "s"}`;
    element("about").textContent = [count(info.object_count, "object"), count(info.triangles, "triangle"), `up ${vector(info.up)}`].join(", ");
    element("warnings").replaceChildren(...info.warnings.map((/** @type {string} */ warning) => make("li", warning)));
}

/** @param {Record<string, {about: string}>} keys */
function listKeys(keys) {
    const others = [["drag, arrows", "turn"], ["Shift drag, right drag, Shift arrows", "move"], ["wheel, + and -", "nearer, farther"], ["click", "keep a point: two and more are measured"]];
    const own = Object.entries(keys).map(([key, { about }]) => [key.length === 1 ? key.toUpperCase() : key, about]);
    for (const [key, about] of [...others, ...own]) element("key-list").append(make("dt", key), make("dd", about));
}
