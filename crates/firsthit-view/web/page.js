// @ts-check
// The page: a picture that is looked at, and questions about it.

import { add, dot, length, OrbitCamera, times, unit } from "./camera.js";
import { parseCamera } from "./camera-text.js";
import { Chapter } from "./chapter.js";
import { Compare } from "./compare.js";
import { CutPlane } from "./cut.js";
import { download, element, make, offer, restoreFields, savedFields, vector, words } from "./dom.js";
import { arrow, listKeys, press } from "./keys.js";
import { LightBall } from "./light-ball.js";
import { lookText } from "./look-text.js";
import { Marks } from "./marks.js";
import { savedLook } from "./saved-look.js";
import { remember, remembered } from "./storage.js";
import { Objects } from "./objects.js";
import { isMapped, Picture } from "./picture.js";
import { controlCamera } from "./pointer.js";
import { probeText } from "./probe-text.js";
import { announce, say } from "./status.js";
import { View } from "./view.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").Engine} Engine */
/** @typedef {import("./engine.js").EnvironmentRequest} EnvironmentRequest */
/** @typedef {import("./engine.js").FrameRequest} FrameRequest */
/** @typedef {{name: string, aim: Vector, up: Vector}} StandardView */

const AS_RENDERED = "as rendered";
const SUN = "a sun: the ball";
/** The choices of the light from all around, and what engines call them. */
const ENVIRONMENTS = /** @type {Record<string, "own" | "none" | "daylight">} */ ({ "the scene's": "own", none: "none", "clear sky": "daylight" });
/** The sine of the height of a sky's sun, at least. */
const LOWEST_SUN = 0.02;
/** The fields that a tab keeps; what else it keeps has an owner of its own. */
const FIELDS = ["channel", "map", "low", "high", "edges", "light", "environment", "environment-strength", "environment-turn", "ground"];
/** Lines along edges are so many pixels wide, where the scene has none. */
const EDGES = 1.5;

export class Page {
    /** Ends what it does outside its own elements. */
    #ended = new AbortController();
    /** The last pixel that was pointed at. @type {[number, number] | null} */
    #lastPixel = null;
    /** What it shows. @type {any} */
    #pointed = null;
    /** The step of the turntable that comes next; 0 where it stands. */
    #turning = 0;
    /** Whether the camera's height is as it is to be: it is fitted to the stage's shape once. */
    #isFitted = false;

    /** @param {Engine} engine @param {any} info what the engine has @param {(file: File) => void} open shows a file in place of this */
    constructor(engine, info, open) {
        this.engine = engine;
        this.info = info;
        const scene = [info.title, info.triangles, info.bounds].join(" ");
        this.lookKey = `firsthit-look ${scene}`;
        this.camera = new OrbitCamera(info.camera, info.up, info.bounds);
        this.picture = new Picture(info);
        this.#introduce();

        const changed = () => this.moved();
        this.marks = new Marks(info.title, scene, () => this.draw());
        this.objects = new Objects(info, changed);
        this.cut = new CutPlane(info.bounds, () => this.camera.aim, changed);
        const axes = () => ({ right: this.camera.axes()[0], up: this.camera.axes()[1], aim: unit(this.camera.aim) });
        this.ball = new LightBall(axes, () => {
            if (element("environment").value !== "clear sky") element("light").value = SUN;
            this.moved();
        });
        // Pictures for other places have an engine of their own: a frame that is asked for meanwhile does not end them.
        this.saver = engine.another();
        this.chapter = new Chapter(info, this.camera, engine.another(), () => this.request(1, 1), changed);
        this.compare = new Compare(() => this.picture.shown);
        const paint = (/** @type {import("./engine.js").Painted} */ painted, /** @type {FrameRequest} */ asked, /** @type {boolean} */ isDone) => {
            this.picture.paint(painted, asked.channel, painted.about.rows === this.view.shape[0], isDone);
            this.compare.draw();
            this.draw();
        };
        this.view = new View(engine, (rows, columns) => this.request(rows, columns), paint, () => this.#rest());
        const { signal } = this.#ended;
        this.tellCamera = newest(() => this.#tellCamera(), signal);
        this.point = newest((/** @type {[number, number]} */ pixel) => this.#point(pixel), signal);

        this.#connectPicture();
        this.#connectViews();
        this.#connectPanel();
        this.#connectCamera();
        this.#connectSaving();
        this.#connectKeys();
        element("open-line").hidden = !(info.opens_files || element("report-module"));
        element("open-file").addEventListener("change", () => {
            const [file] = element("open-file").files;
            if (file) open(file);
        });
        this.#restore();
        this.marks.restore();
        this.#watch();
        document.body.dataset.ready = "yes";
    }

    /** Ends all that goes on. */
    end() {
        this.#ended.abort();
        this.view.end();
        cancelAnimationFrame(this.#turning);
        this.engine.close();
    }

    /** The camera with so many pixels. @param {number} rows @param {number} columns */
    flatCamera(rows, columns) {
        return this.chapter.isOpen ? this.chapter.flat() : this.camera.flat(rows, columns);
    }

    /** What is seen of the scene. @returns {import("./engine.js").Visibility} */
    part() {
        return { ...this.objects.asked(), cut: this.cut.plane() };
    }

    /** What to ask for. @param {number} rows @param {number} columns @returns {FrameRequest} */
    request(rows, columns) {
        const { info, cut } = this;
        const light = element("light").value;
        const environment = this.#environment();
        const hasSun = light === SUN || (environment?.choice === "daylight" && this.ball.direction !== null);
        return {
            camera: this.flatCamera(rows, columns),
            channel: element("channel").value,
            samples: 1,
            is_lit: false,
            light: info.lights.includes(light) ? light : null,
            sun: hasSun && this.ball.direction ? this.#sun(this.ball.direction, environment?.choice === "daylight") : null,
            environment,
            colors: [...this.objects.colors],
            ground: [null, true, false][element("ground").selectedIndex],
            // Edges are those of whole surfaces.
            edges: cut.plane() ? 0 : element("edges").checked ? (info.edges ?? EDGES) : 0,
            part: this.part(),
        };
    }

    /** Where the sun's light goes; that of a sky has its sun above the horizon. @param {Vector} direction @param {boolean} isOfSky */
    #sun(direction, isOfSky) {
        const up = this.camera.sceneUp;
        const height = -dot(direction, up);
        if (!isOfSky || height >= LOWEST_SUN) return direction;
        const level = add(direction, times(height, up));
        return add(level, times(-LOWEST_SUN * Math.max(length(level), LOWEST_SUN), up));
    }

    /** The light from all around that was chosen. @returns {EnvironmentRequest | null} */
    #environment() {
        const choice = ENVIRONMENTS[element("environment").value];
        if (!choice) return null;
        const [strength, turn] = ["environment-strength", "environment-turn"].map((id) => {
            const text = element(id).value.trim();
            const isGood = text !== "" && Number.isFinite(Number(text)) && (id === "environment-turn" || Number(text) >= 0);
            element(id).setAttribute("aria-invalid", String(!isGood));
            return isGood ? Number(text) : null;
        });
        return { choice, strength: strength ?? 1, turn: turn ?? 0 };
    }

    /** Something is to be seen otherwise. */
    moved() {
        const { chapter, view } = this;
        chapter.moved();
        view.fixed = chapter.isOpen ? [chapter.flat().rows, chapter.flat().columns] : null;
        const isCut = this.cut.plane() !== null;
        element("edges").disabled = element("save-rendered").disabled = isCut;
        element("save-rendered").title = isCut ? "firsthit render knows no section plane: save the picture as shown" : "";
        this.#place();
        view.moved();
        this.tellCamera();
        remember(this.lookKey, JSON.stringify(this.#saved()));
    }

    /** The picture is as good as it gets. */
    #rest() {
        // What is under the pointer may be something else by now.
        if (this.#lastPixel) this.point(this.#lastPixel);
        announce(element("message").textContent);
    }

    /** What the tab keeps. */
    #saved() {
        const { camera, objects, cut, ball } = this;
        return { camera: camera.saved(), home: camera.home, fields: savedFields(FIELDS), objects: objects.saved(), cut: cut.saved(), ball: ball.saved() };
    }

    /** Goes on where the page was before it was loaded again. */
    #restore() {
        const { camera, objects, cut, ball } = this;
        const saved = savedLook(remembered(this.lookKey), this.info.object_count);
        if (!saved) return;
        Object.assign(camera, saved.camera, { home: saved.home });
        restoreFields(saved.fields);
        objects.restore(saved.objects);
        cut.restore(saved.cut);
        ball.restore(saved.ball);
        element("orthographic").checked = camera.projection === "orthographic";
        this.#showFields();
        this.#isFitted = true;
    }

    /** Shows the fields that something chosen has. */
    #showFields() {
        element("map-label").hidden = element("range-label").hidden = !isMapped(element("channel").value);
        element("environment-label").hidden = !["own", "daylight"].includes(ENVIRONMENTS[element("environment").value]);
    }

    /** Where the picture lies on the stage: all over it, but for the chapter's, which has a shape of its own. */
    #place() {
        const { chapter } = this;
        const stage = element("stage");
        const [wide, high] = [stage.clientWidth, stage.clientHeight];
        let [width, height] = [wide, high];
        if (chapter.isOpen) {
            const { width: w, height: h } = chapter.flat();
            const fit = Math.min(wide / w, high / h);
            [width, height] = [w * fit, h * fit];
        }
        element("picture").classList.toggle("pixels", chapter.isOpen);
        for (const id of ["picture", "overlay", "before"]) {
            Object.assign(element(id).style, { left: `${(wide - width) / 2}px`, top: `${(high - height) / 2}px`, width: `${width}px`, height: `${height}px` });
        }
        this.draw();
    }

    /** Marks, over the picture. */
    draw() {
        const overlay = element("overlay");
        const scale = devicePixelRatio;
        const [rows, columns] = [overlay.clientHeight, overlay.clientWidth];
        [overlay.width, overlay.height] = [Math.round(scale * columns), Math.round(scale * rows)];
        const on = overlay.getContext("2d");
        on.scale(scale, scale);
        this.marks.draw(on, (point) => this.camera.pixelOf(point, rows, columns));
        if (this.chapter.isOpen) this.chapter.frameFollowed(on, rows, columns);
    }

    /** Columns to rows. */
    get aspect() {
        return this.view.columns / this.view.rows;
    }

    /** Title, counts and warnings, and what there is to choose from. */
    #introduce() {
        const { info } = this;
        element("title").textContent = info.title;
        document.title = `${info.title} - firsthit`;
        const count = (/** @type {number} */ n, /** @type {string} */ noun) => `${n.toLocaleString("en")} ${noun}${n === 1 ? "" : "s"}`;
        element("about").textContent = [count(info.object_count, "object"), count(info.triangles, "triangle"), `up ${vector(info.up)}`].join(", ");
        element("warnings").replaceChildren(...info.warnings.map((/** @type {string} */ warning) => make("li", warning)));
        offer("channel", info.channels.map((/** @type {any} */ channel) => channel.name));
        offer("map", Object.keys(info.maps));
        offer("light", [AS_RENDERED, SUN, ...info.lights]);
        const environments = Object.keys(ENVIRONMENTS).filter((name) => info.environment || ENVIRONMENTS[name] === "daylight");
        offer("environment", [AS_RENDERED, ...environments]);
        element("map").value = "viridis";
        element("edges").checked = info.edges !== null;
        element("orthographic").checked = this.camera.projection === "orthographic";
    }

    /** @param {[number, number]} pixel */
    async #point(pixel) {
        this.#lastPixel = pixel;
        const [rows, columns] = this.view.shape;
        if (pixel[0] >= columns || pixel[1] >= rows) return;
        const { text, ...probed } = await this.engine.probe(this.flatCamera(rows, columns), pixel, this.part());
        if (this.#ended.signal.aborted) return;
        this.#pointed = probed;
        element("probe").textContent = probeText(probed);
        element("probe").title = text;
        element("copy-probe").disabled = false;
        this.objects.point(probed.hit ? probed.hit.object : null);
        if (this.chapter.isOpen) {
            this.chapter.follow(pixel, probed, this.picture.colorAt(pixel));
            this.draw();
        }
        document.body.dataset.probed = pixel.join(",");
    }

    /** Keeps the point that a pixel shows. @param {[number, number]} pixel */
    async #keep(pixel) {
        try {
            const { hit, cut_face: face } = await this.engine.probe(this.flatCamera(...this.view.shape), pixel, this.part());
            if (this.#ended.signal.aborted) return;
            if (hit) this.marks.add(face ?? hit);
            else say("The ray of this pixel meets nothing: there is no point to keep.", true);
        } catch (error) {
            say(words(error), true);
        }
    }

    #connectPicture() {
        const { picture: { canvas }, camera } = this;
        const pixelAt = (/** @type {PointerEvent} */ event) => {
            const box = canvas.getBoundingClientRect();
            const [rows, columns] = this.view.shape;
            const column = Math.floor(((event.clientX - box.left) / box.width) * columns);
            const row = Math.floor(((event.clientY - box.top) / box.height) * rows);
            return /** @type {[number, number]} */ ([Math.max(0, Math.min(columns - 1, column)), Math.max(0, Math.min(rows - 1, row))]);
        };
        controlCamera(canvas, camera, {
            moved: () => this.moved(),
            point: (event) => this.point(pixelAt(event)),
            keep: (event) => this.#keep(pixelAt(event)),
        });
    }

    #connectViews() {
        // All begins with the view "iso".
        /** @type {StandardView[]} */
        this.standardViews = this.info.views.filter((/** @type {StandardView} */ one) => one.name !== "iso");
        for (const one of this.standardViews) {
            const button = make("button", one.name);
            button.addEventListener("click", () => this.#lookAlong(one));
            element("views").append(button);
        }
        element("frame").addEventListener("click", () => {
            this.camera.frame(this.aspect);
            this.moved();
        });
        element("turn").addEventListener("click", () => this.#turn());
        element("orthographic").addEventListener("change", () => {
            this.camera.project(element("orthographic").checked ? "orthographic" : "perspective");
            this.moved();
        });
    }

    /** @param {StandardView} one */
    #lookAlong({ aim, up }) {
        this.camera.lookAlong(aim, up, this.aspect);
        this.moved();
    }

    /** The turntable begins, or stands. */
    #turn() {
        const step = () => {
            this.camera.orbit(-0.015, 0);
            this.moved();
            this.#turning = requestAnimationFrame(step);
        };
        if (this.#turning) {
            cancelAnimationFrame(this.#turning);
            this.#turning = 0;
        } else {
            step();
        }
        element("turn").setAttribute("aria-pressed", String(this.#turning !== 0));
    }

    #connectPanel() {
        const chosen = () => {
            this.#showFields();
            this.moved();
        };
        element("channel").addEventListener("change", () => {
            // A range is of one channel.
            for (const id of ["low", "high"]) element(id).value = "";
            chosen();
        });
        for (const id of ["map", "low", "high"]) element(id).addEventListener("change", chosen);
        for (const id of ["ground", "edges", "environment-strength", "environment-turn"]) element(id).addEventListener("change", () => this.moved());
        element("light").addEventListener("change", () => {
            if (element("light").value === SUN) this.ball.shine();
            else this.ball.clear();
            this.moved();
        });
        element("environment").addEventListener("change", chosen);
        element("fix-range").addEventListener("click", () => {
            const { range } = this.picture;
            if (range) [element("low").value, element("high").value] = range.map(String);
            chosen();
        });
        element("help").addEventListener("click", () => element("keys").showModal());
        element("close-keys").addEventListener("click", () => element("keys").close());
        element("copy-probe").addEventListener("click", () => copy(JSON.stringify(this.#pointed, null, 2)));
    }

    async #tellCamera() {
        const texts = await this.engine.cameraText(this.flatCamera(...this.view.shape));
        if (this.#ended.signal.aborted) return;
        const wanted = texts[element("say-as").value];
        const text = typeof wanted === "string" ? wanted : JSON.stringify(wanted);
        const isCommand = element("say-as").value === "command";
        const { options, missing } = lookText(this.request(...this.view.shape), this.info);
        element("said").textContent = wanted === null ? "Parallel rays have no matrix of pixels." : isCommand ? [text, ...options].join(" ") : text;
        const unsaid = isCommand || options.length === 0 ? missing : [...missing, options.join(" ")];
        element("unsaid").textContent = unsaid.length > 0 ? `Not said here: ${unsaid.join(", ")}.` : "";
    }

    #connectCamera() {
        element("say-as").addEventListener("change", () => this.tellCamera());
        element("copy-camera").addEventListener("click", () => copy(element("said").textContent));
        element("take-camera").addEventListener("click", async () => {
            try {
                const [rows, columns] = this.view.shape;
                const given = parseCamera(element("heard").value, rows, columns, this.info.up);
                // The engine refuses what is no camera.
                await this.engine.cameraText(given);
                this.camera.take(given);
                if (this.chapter.isOpen) this.chapter.take(given);
                element("orthographic").checked = this.camera.projection === "orthographic";
                this.moved();
            } catch (error) {
                say(words(error), true);
            }
        });
    }

    #connectSaving() {
        const { view } = this;
        /** @param {string} name @param {() => Promise<Blob | undefined>} make */
        const save = async (name, make) => {
            try {
                const blob = await make();
                if (blob) download(name, blob);
            } catch (error) {
                say(words(error), true);
            }
        };
        element("save-shown").addEventListener("click", () => save("view.png", () => this.picture.asShown()));
        element("save-rendered").addEventListener("click", () => {
            const whole = { ...this.request(...view.shape), samples: null, is_lit: true, channel: "color" };
            return save("render.png", async () => (view.full ?? (await this.saver.frame(whole, this.#ended.signal))).blob);
        });
    }

    #connectKeys() {
        const { camera, objects } = this;
        const click = (/** @type {string} */ id) => () => element(id).click();
        const next = (/** @type {string} */ id) => () => {
            const list = element(id);
            list.selectedIndex = (list.selectedIndex + 1) % list.options.length;
            list.dispatchEvent(new Event("change"));
        };
        /** @type {Record<string, import("./keys.js").Key>} */
        const keys = {
            f: { about: "all in the picture", act: click("frame") },
            0: { about: "as at the beginning", act: () => {
                camera.reset();
                element("orthographic").checked = camera.projection === "orthographic";
                this.moved();
            } },
            o: { about: "orthographic or perspective", act: click("orthographic") },
            g: { about: "ground: as rendered, with, without", act: next("ground") },
            e: { about: "edges", act: click("edges") },
            t: { about: "turn by itself", act: () => this.#turn() },
            c: { about: "next channel", act: next("channel") },
            h: { about: "hide the object under the pointer", act: () => {
                const { hit } = this.#pointed ?? {};
                if (hit) objects.show((object) => object !== hit.object && !objects.hidden.has(object));
            } },
            u: { about: "undo the last mark, or bring back those that were cleared", act: click("undo") },
            Escape: { about: "clear marks", act: click("clear") },
            Enter: { about: "keep the point in the picture's middle", act: () => {
                const [rows, columns] = this.view.shape;
                /** @type {[number, number]} */
                const middle = [columns >> 1, rows >> 1];
                this.point(middle);
                this.#keep(middle);
            } },
            "?": { about: "this list", act: click("help") },
        };
        this.standardViews?.forEach((one, k) => (keys[k + 1] = { about: `${one.name} view`, act: () => this.#lookAlong(one) }));
        listKeys(keys);
        const steer = (/** @type {string} */ key, /** @type {boolean} */ isShifted) => this.#steer(key, isShifted);
        addEventListener("keydown", (event) => press(event, keys, steer), { signal: this.#ended.signal });
    }

    /** Moves the camera by a key; says whether it is one for that. @param {string} key @param {boolean} isShifted */
    #steer(key, isShifted) {
        const { camera } = this;
        const way = arrow(key);
        const nearer = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[key];
        if (way && isShifted) camera.pan(-0.05 * way[0], 0.05 * way[1]);
        else if (way) camera.orbit(-0.1 * way[0], -0.1 * way[1]);
        else if (nearer) camera.zoom(nearer, 0, 0);
        else return false;
        this.moved();
        return true;
    }

    /** Follows the stage's size. */
    #watch() {
        const stage = element("stage");
        const observer = new ResizeObserver(() => {
            const [rows, columns] = [stage.clientHeight, stage.clientWidth].map((edge) => Math.max(1, Math.round(edge * devicePixelRatio)));
            if (!this.#isFitted) this.camera.keepWidth(columns / rows);
            this.#isFitted = true;
            this.#place();
            this.view.resize(rows, columns);
            this.tellCamera();
        });
        observer.observe(stage);
        this.#ended.signal.addEventListener("abort", () => observer.disconnect());
    }
}

/** @param {string} text */
async function copy(text) {
    try {
        await navigator.clipboard.writeText(text);
        say("Copied.", false);
    } catch {
        say("The browser did not let the page copy: mark the text and copy it.", true);
    }
}

/** Does something for the newest of many calls: one at a time, and of those that wait the last. @template {any[]} T @param {(...given: T) => Promise<void>} act @param {AbortSignal} ended after which nothing is said any more @returns {(...given: T) => Promise<void>} */
function newest(act, ended) {
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
                if (!ended.aborted) say(words(error), true);
            }
        }
        isAtIt = false;
    };
}
