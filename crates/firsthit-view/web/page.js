// @ts-check
// The page: a picture that is looked at, and questions about it.

import { OrbitCamera, unit } from "./camera.js";
import { CameraPanel } from "./camera-panel.js";
import { Chapter } from "./chapter.js";
import { Compare } from "./compare.js";
import { CutPlane } from "./cut.js";
import { disable, download, element, make, offer, restoreFields, savedFields, vector, words } from "./dom.js";
import { Lighting } from "./lighting.js";
import { Marks } from "./marks.js";
import { savedLook } from "./saved-look.js";
import { newest } from "./newest.js";
import { Objects } from "./objects.js";
import { connectKeys } from "./page-keys.js";
import { isMapped, Picture } from "./picture.js";
import { controlCamera } from "./pointer.js";
import { probeRows } from "./probe-text.js";
import { connectDigits, readOut } from "./readout.js";
import { announce, copy, explain, say } from "./status.js";
import { remember, remembered } from "./storage.js";
import { View } from "./view.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").Engine} Engine */
/** @typedef {import("./engine.js").FrameRequest} FrameRequest */
/** @typedef {{name: string, aim: Vector, up: Vector}} StandardView */

/** The fields that a tab keeps; what else it keeps has an owner of its own. */
const FIELDS = ["channel", "map", "low", "high", "edges", "light", "environment", "environment-strength", "environment-turn", "ground"];
/** Lines along edges are so many pixels wide, where the scene has none. */
const EDGES = 1.5;

export class Page {
    /** Ends what it does outside its own elements. */
    #ended = new AbortController();
    /** The row and column that was pointed at last. @type {[number, number] | null} */
    #lastPixel = null;
    /** What it shows. @type {any} */
    pointed = null;
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
        this.cut = new CutPlane(engine, info.bounds, () => this.camera.aim, () => this.part(), changed);
        this.lighting = new Lighting(info, this.camera, changed);
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
        this.cameraPanel = new CameraPanel(this);
        this.tellCamera = newest(() => this.cameraPanel.tell(signal), signal);
        this.measureCut = newest(() => this.cut.measure(), signal);
        this.point = newest((/** @type {[number, number]} */ pixel) => this.#point(pixel), signal);

        this.#connectPicture();
        this.#connectViews();
        this.#connectPanel();
        this.#connectSaving();
        connectKeys(this, signal);
        connectDigits(signal);
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
        return {
            camera: this.flatCamera(rows, columns),
            channel: element("channel").value,
            samples: 1,
            is_lit: false,
            ...this.lighting.asked(),
            colors: [...this.objects.colors],
            ground: [null, true, false][element("ground").selectedIndex],
            // Edges are those of whole surfaces.
            edges: cut.plane() ? 0 : element("edges").checked ? (info.edges ?? EDGES) : 0,
            cut_color: cut.color(),
            part: this.part(),
        };
    }

    /** Something is to be seen otherwise. */
    moved() {
        const { chapter, view } = this;
        chapter.moved();
        view.fixed = chapter.isOpen ? [chapter.flat().rows, chapter.flat().columns] : null;
        const isCut = this.cut.plane() !== null;
        disable("edges", isCut && "Not in a section.");
        disable("save-rendered", isCut && "firsthit render knows no section plane: save the picture as shown.");
        this.#place();
        view.moved();
        this.tellCamera();
        remember(this.lookKey, JSON.stringify(this.#saved()));
    }

    /** The picture is as good as it gets. */
    #rest() {
        // What is under the pointer may be something else by now.
        if (this.#lastPixel) this.point(this.#lastPixel);
        this.measureCut();
        announce(element("message").textContent);
    }

    /** What the tab keeps. */
    #saved() {
        const { camera, objects, cut, lighting: { ball } } = this;
        return { camera: camera.saved(), home: camera.home, fields: savedFields(FIELDS), objects: objects.saved(), cut: cut.saved(), ball: ball.saved() };
    }

    /** Goes on where the page was before it was loaded again. */
    #restore() {
        const { camera, objects, cut, lighting: { ball } } = this;
        const saved = savedLook(remembered(this.lookKey), this.info.object_count);
        if (!saved) return;
        Object.assign(camera, saved.camera, { home: saved.home });
        restoreFields(saved.fields);
        objects.restore(saved.objects);
        cut.restore(saved.cut);
        ball.restore(saved.ball);
        this.lighting.showFields();
        this.showProjection();
        this.#showFields();
        this.#isFitted = true;
    }

    /** Shows the fields that something chosen has. */
    #showFields() {
        element("map-label").hidden = element("range-label").hidden = !isMapped(element("channel").value);
    }

    /** Both switches say how rays go. */
    showProjection() {
        for (const id of ["orthographic", "chapter-orthographic"]) element(id).checked = this.camera.projection === "orthographic";
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
        element("map").value = "viridis";
        element("edges").checked = info.edges !== null;
        element("version").textContent = info.version;
        this.showProjection();
        readOut(element("probe"), probeRows(null, false));
        disable("copy-probe", "Point at the picture first.");
    }

    /** @param {[number, number]} pixel row and column */
    async #point(pixel) {
        this.#lastPixel = pixel;
        const [rows, columns] = this.view.shape;
        if (pixel[0] >= rows || pixel[1] >= columns) return;
        const probed = await this.engine.probe(this.flatCamera(rows, columns), pixel, this.part());
        if (this.#ended.signal.aborted) return;
        this.pointed = probed;
        readOut(element("probe"), probeRows(probed, this.cut.plane() !== null));
        disable("copy-probe", false);
        this.objects.point(probed.hit ? probed.hit.object : null);
        if (this.chapter.isOpen) {
            this.chapter.follow(pixel, probed, this.picture.colorAt(pixel));
            this.draw();
        }
        document.body.dataset.probed = pixel.join(",");
    }

    /** Keeps the point that a pixel shows. @param {[number, number]} pixel */
    async keep(pixel) {
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
            return /** @type {[number, number]} */ ([Math.max(0, Math.min(rows - 1, row)), Math.max(0, Math.min(columns - 1, column))]);
        };
        controlCamera(canvas, camera, {
            moved: () => this.moved(),
            point: (event) => this.point(pixelAt(event)),
            keep: (event) => this.keep(pixelAt(event)),
        });
    }

    #connectViews() {
        // All begins with the view "iso".
        /** @type {StandardView[]} */
        this.standardViews = this.info.views.filter((/** @type {StandardView} */ one) => one.name !== "iso");
        for (const one of this.standardViews) {
            const button = make("button", one.name);
            button.addEventListener("click", () => this.lookAlong(one));
            element("views").append(button);
        }
        element("frame").addEventListener("click", () => {
            this.camera.frame(this.aspect);
            this.moved();
        });
        element("turn").addEventListener("click", () => this.turn());
        for (const id of ["orthographic", "chapter-orthographic"]) {
            element(id).addEventListener("change", () => {
                this.camera.project(element(id).checked ? "orthographic" : "perspective");
                this.showProjection();
                this.moved();
            });
        }
    }

    /** @param {StandardView} one */
    lookAlong({ aim, up }) {
        this.camera.lookAlong(aim, up, this.aspect);
        this.moved();
    }

    /** The turntable begins, or stands. */
    turn() {
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
        for (const id of ["ground", "edges"]) element(id).addEventListener("change", () => this.moved());
        element("fix-range").addEventListener("click", () => {
            const { range } = this.picture;
            if (range) [element("low").value, element("high").value] = range.map(String);
            chosen();
        });
        element("help").addEventListener("click", () => element("keys").showModal());
        element("close-keys").addEventListener("click", () => element("keys").close());
        // What does nothing says why.
        const refuse = (/** @type {MouseEvent} */ event) => {
            const control = event.target instanceof Element && event.target.closest("[aria-disabled=true]");
            if (!(control instanceof HTMLElement)) return;
            event.preventDefault();
            event.stopImmediatePropagation();
            explain(control.title);
        };
        document.addEventListener("click", refuse, { capture: true, signal: this.#ended.signal });
        element("copy-probe").addEventListener("click", () => copy(JSON.stringify(this.pointed, null, 2)));
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
