// @ts-check
// The chapter alive: a camera by its own numbers, its viewplane as a second camera sees it, and one pixel's ray to its hit.

import { add, cross, dot, length, minus, OrbitCamera, times, unit } from "./camera.js";
import { element, plain, six, threeNumbers, vector } from "./dom.js";
import { say } from "./status.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").FlatCamera} FlatCamera */

/** The most lines that are drawn of the viewplane's pixels, along an edge. */
const MOST_LINES = 48;
/** The most rows and columns: the chapter's pixels are to be seen. */
const MOST_PIXELS = 512;
const WANTED = `z_p, w and h are positive, M and N whole and at most ${MOST_PIXELS}; x_c, u_c and v_up are three numbers each, and v_up is not along u_c.`;
const VECTORS = ["x_c", "u_c", "v_up"];
const LENGTHS = ["z_p", "w", "h"];
const COUNTS = ["M", "N"];

export class Chapter {
    /**
     * @param {any} info
     * @param {OrbitCamera} camera the page's
     * @param {import("./engine.js").Engine} engine makes the picture behind the drawing
     * @param {() => import("./engine.js").FrameRequest} request what the page asks for
     * @param {() => void} changed
     */
    constructor(info, camera, engine, request, changed) {
        this.info = info;
        this.camera = camera;
        this.engine = engine;
        this.request = request;
        /** Lengths and counts of the viewplane, once they make sense. @type {Record<string, number> | null} */
        this.plane = null;
        /** The second camera; it begins when the chapter is opened. @type {OrbitCamera | null} */
        this.second = null;
        /** @type {ImageBitmap | null} */
        this.behind = null;
        this.isAsking = false;
        this.isStale = false;
        /** The pixel that is followed, what it shows, and its colour. @type {{pixel: [number, number], probed: any, color: number[]} | null} */
        this.followed = null;
        const panel = element("chapter");
        panel.addEventListener("toggle", () => {
            if (panel.open) this.#begin();
            else this.plane = null;
            changed();
        });
        for (const name of [...VECTORS, ...LENGTHS, ...COUNTS]) {
            element(`chapter-${name}`).addEventListener("change", () => {
                this.#read();
                changed();
            });
        }
        element("chapter-start").addEventListener("change", () => {
            camera.rayStart = element("chapter-start").value;
            changed();
        });
        this.#handle(element("chapter-scene"));
    }

    get isOpen() {
        return element("chapter").open && this.plane !== null;
    }

    /** The viewplane stands at a third of the way to what is looked at, and rays start there. */
    #begin() {
        const { camera } = this;
        const [M, N] = [12, 16];
        const z_p = Number((0.35 * camera.distance).toPrecision(3));
        const high = camera.projection === "perspective" ? (camera.height * z_p) / camera.focal : camera.height;
        const h = Number(high.toPrecision(3));
        camera.rayStart = "viewplane";
        this.#set({ z_p, h, w: Number(((h * N) / M).toPrecision(3)), M, N });
        this.#write();
        this.frame();
    }

    /** Takes a viewplane, and gives it to the camera. @param {Record<string, number>} plane */
    #set(plane) {
        this.plane = plane;
        const { camera } = this;
        [camera.focal, camera.height] = [plane.z_p, plane.h];
        camera.given = { ...camera.given, rows: plane.M, columns: plane.N, width: plane.w, height: plane.h };
    }

    /** Takes the viewplane of another camera. @param {FlatCamera} given */
    take(given) {
        const isSmall = given.rows <= MOST_PIXELS && given.columns <= MOST_PIXELS;
        const [M, N] = isSmall ? [given.rows, given.columns] : [this.plane?.M ?? 12, this.plane?.N ?? 16];
        this.#set({ z_p: given.focal_length, w: given.width, h: given.height, M, N });
    }

    /** Brings everything into the second picture. */
    frame() {
        const places = [...this.#corners(), this.camera.position, ...this.#box()];
        const bounds = /** @type {[Vector, Vector]} */ ([Math.min, Math.max].map((most) => [0, 1, 2].map((axis) => most(...places.map((place) => place[axis])))));
        const { camera } = this;
        const aside = unit(add(times(-0.9, camera.axes()[0]), add(times(0.55, unit(camera.aim)), times(-0.45, camera.sceneUp))));
        const given = /** @type {FlatCamera} */ ({ ...camera.flat(3, 4), position: [0, 0, 0], aim: aside, up: camera.sceneUp, projection: "perspective", ray_start: "eye", focal_length: 1, width: (0.7 * 4) / 3, height: 0.7 });
        this.second = new OrbitCamera(given, camera.sceneUp, bounds);
        this.second.frame(4 / 3);
    }

    /** Numbers of the camera, which the mouse may have moved. */
    #write() {
        const { camera } = this;
        if (this.plane && camera.height !== this.plane.h) {
            // It came nearer with parallel rays, or changes from those.
            const w = (this.plane.w * camera.height) / this.plane.h;
            this.#set({ ...this.plane, z_p: camera.focal, w, h: camera.height });
        }
        const said = /** @type {Record<string, string>} */ ({ x_c: vector(camera.position), u_c: vector(camera.aim), v_up: vector(camera.up) });
        for (const name of [...LENGTHS, ...COUNTS]) said[name] = six(this.plane?.[name] ?? 0);
        for (const [name, text] of Object.entries(said)) {
            const field = element(`chapter-${name}`);
            if (document.activeElement !== field) field.value = text;
        }
        element("chapter-start").value = camera.rayStart;
    }

    /** Takes what was typed, where it makes sense; marks what does not. */
    #read() {
        const { camera } = this;
        /** @type {Record<string, number>} */
        const numbers = {};
        for (const name of [...LENGTHS, ...COUNTS]) {
            const field = element(`chapter-${name}`);
            const value = Number(field.value);
            const isGood = value > 0 && Number.isFinite(value) && (!COUNTS.includes(name) || (Number.isInteger(value) && value <= MOST_PIXELS));
            field.setAttribute("aria-invalid", String(!isGood));
            // What is shown has fewer digits than what is known.
            if (isGood) numbers[name] = this.plane && six(this.plane[name]) === field.value ? this.plane[name] : value;
        }
        const vectors = VECTORS.map((name) => {
            const found = threeNumbers(element(`chapter-${name}`).value);
            element(`chapter-${name}`).setAttribute("aria-invalid", String(found === null));
            return found;
        });
        const [position, aim, up] = vectors;
        const isWhole = Object.keys(numbers).length === 5 && position && aim && up;
        const isAimed = isWhole && length(cross(aim, up)) > 1e-9 * length(aim) * length(up);
        if (!isWhole || !isAimed) {
            if (isWhole) element("chapter-v_up").setAttribute("aria-invalid", "true");
            say(WANTED, true);
            return;
        }
        if (vector(camera.position) !== vector(position)) camera.position = position;
        if (vector(camera.aim) !== vector(aim)) camera.aim = aim;
        if (vector(camera.up) !== vector(up)) camera.up = up;
        this.#set(numbers);
    }

    /** The camera by the chapter's numbers. @returns {FlatCamera} */
    flat() {
        const { M, N } = /** @type {Record<string, number>} */ (this.plane);
        return this.camera.flat(M, N);
    }

    /** The viewplane's frame: its middle, and its axes. */
    #frame() {
        const [right, up] = this.camera.axes();
        const z_p = this.plane?.z_p ?? 1;
        return { middle: add(this.camera.position, times(z_p, unit(this.camera.aim))), right, up };
    }

    /** A point of the viewplane, by shares of its width and height from the middle. @param {number} x @param {number} y @returns {Vector} */
    #onPlane(x, y) {
        const { middle, right, up } = this.#frame();
        const { w, h } = this.plane ?? { w: 1, h: 1 };
        return add(middle, add(times(x * w, right), times(y * h, up)));
    }

    #corners() {
        return [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]].map(([x, y]) => this.#onPlane(x, y));
    }

    /** The corners of the scene's box. @returns {Vector[]} */
    #box() {
        const bounds = this.info.bounds ?? [[-1, -1, -1], [1, 1, 1]];
        return [0, 1, 2, 3, 4, 5, 6, 7].map((k) => [bounds[k & 1][0], bounds[(k >> 1) & 1][1], bounds[k >> 2][2]]);
    }

    /** The camera has moved, or the numbers are others. */
    moved() {
        if (!this.isOpen) return;
        this.#write();
        this.followed = null;
        this.isStale = true;
        this.draw();
    }

    /** @param {[number, number]} pixel column and row @param {any} probed @param {number[]} color */
    follow(pixel, probed, color) {
        this.followed = { pixel, probed, color };
        element("chapter-words").textContent = this.#words();
        this.draw();
    }

    /** Frames the pixel that is followed, in the page's own picture. @param {CanvasRenderingContext2D} on @param {number} rows of the canvas @param {number} columns */
    frameFollowed(on, rows, columns) {
        if (!this.followed || !this.plane) return;
        const { followed: { pixel: [column, row] }, plane: { M, N } } = this;
        on.strokeStyle = "#ffd166";
        on.lineWidth = 2;
        on.strokeRect((column * columns) / N, (row * rows) / M, columns / N, rows / M);
    }

    /** Everything that the chapter says of a ray, with this pixel's numbers. */
    #words() {
        if (!this.followed || !this.plane) return "";
        const { pixel: [column, row], probed, color } = this.followed;
        const { z_p, w, h, M, N } = this.plane;
        const { middle, right, up } = this.#frame();
        const [i, j] = [M - 1 - row, column];
        const [x, y] = [-w / 2 + (w / N) * (j + 0.5), -h / 2 + (h / M) * (i + 0.5)];
        const p = add(middle, add(times(x, right), times(y, up)));
        const { origin, direction } = probed.ray;
        const isParallel = this.camera.projection === "orthographic";
        const isFromEye = this.camera.rayStart === "eye";
        const { hit } = probed;
        return [
            `pixel (i, j) = (${i}, ${j}): row ${row} from the top`,
            `c_0 = x_c + z_p u_c = ${vector(middle)}`,
            `u_x = u_c x v_up / |...| = ${vector(right)}`,
            `u_y = u_z x u_x, u_z = -u_c: ${vector(up)}`,
            `p_x = -w/2 + (w/N)(j + 1/2) = ${Number(x.toPrecision(6))}`,
            `p_y = -h/2 + (h/M)(i + 1/2) = ${Number(y.toPrecision(6))}`,
            `p = c_0 + p_x u_x + p_y u_y = ${vector(p)}`,
            isParallel ? `u_r = u_c = ${vector(direction)}` : `u_r = (p - x_c) / |p - x_c| = ${vector(direction)}`,
            isFromEye ? `the ray starts at the eye: ${vector(origin)}` : `the ray starts on the viewplane: ${vector(origin)}`,
            "",
            `shoot(p, u_r) = (t, o)`,
            hit ? `  t = ${hit.t}\n  o = ${hit.object} ${plain(hit.name || hit.shape)}` : "  t = infinity, and no object",
            hit ? `x = p + t u_r = ${vector(hit.position)}` : "",
            "",
            `shade(t, p, u_r, o) = ${color.slice(0, 3).join(", ")} of 255, as shown`,
            hit ? `  normal ${vector(hit.normal)}, cosine to the ray ${Number((-dot(hit.normal, direction)).toPrecision(4))}` : "  the background",
        ].join("\n");
    }

    draw() {
        const { second } = this;
        if (!this.isOpen || !second || !this.plane) return;
        const canvas = element("chapter-scene");
        const [rows, columns] = [canvas.height, canvas.width];
        const on = canvas.getContext("2d");
        on.clearRect(0, 0, columns, rows);
        if (this.behind) on.drawImage(this.behind, 0, 0, columns, rows);
        /** @param {Vector[]} points @param {string} color @param {number} width */
        const line = (points, color, width) => {
            const places = points.map((point) => second.pixelOf(point, rows, columns));
            on.strokeStyle = color;
            on.lineWidth = width;
            on.beginPath();
            places.forEach((place, k) => {
                const before = places[k - 1];
                if (!place) return;
                if (before) on.lineTo(...place);
                else on.moveTo(...place);
            });
            on.stroke();
        };
        const { M, N } = this.plane;
        const eye = this.camera.position;
        const corners = this.#corners();
        const isParallel = this.camera.projection === "orthographic";
        for (let k = 1; k < N && N <= MOST_LINES; k++) line([this.#onPlane(k / N - 0.5, -0.5), this.#onPlane(k / N - 0.5, 0.5)], "#7fb2dd88", 1);
        for (let k = 1; k < M && M <= MOST_LINES; k++) line([this.#onPlane(-0.5, k / M - 0.5), this.#onPlane(0.5, k / M - 0.5)], "#7fb2dd88", 1);
        line([...corners, corners[0]], "#4fb3ff", 2);
        if (!isParallel) for (const corner of corners) line([eye, corner], "#4fb3ff66", 1);
        line([eye, this.#frame().middle], "#9be28f", 1.5);
        this.#drawFollowed(on, line, rows, columns);
        on.font = "13px system-ui, sans-serif";
        on.fillStyle = "#fff";
        on.shadowColor = "#000";
        on.shadowBlur = 4;
        for (const [text, point] of /** @type {[string, Vector][]} */ ([["x_c", eye], ["c_0", this.#frame().middle]])) {
            const place = second.pixelOf(point, rows, columns);
            if (!place) continue;
            on.beginPath();
            on.arc(place[0], place[1], 3, 0, 2 * Math.PI);
            on.fill();
            on.fillText(text, place[0] + 6, place[1] - 5);
        }
        on.shadowBlur = 0;
        if (this.isStale) this.#ask();
    }

    /** The pixel and its ray. @param {any} on @param {(points: Vector[], color: string, width: number) => void} line @param {number} rows @param {number} columns */
    #drawFollowed(on, line, rows, columns) {
        const { followed, second, plane } = this;
        if (!followed || !second || !plane) return;
        const { M, N } = plane;
        const { pixel: [column, row], probed: { ray, hit }, color } = followed;
        const [x, y] = [column / N - 0.5, 0.5 - (row + 1) / M];
        const square = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([dx, dy]) => this.#onPlane(x + dx / N, y + dy / M));
        const places = square.map((point) => second.pixelOf(point, rows, columns));
        if (places.every((place) => place !== null)) {
            on.fillStyle = `rgb(${color.slice(0, 3).join(" ")})`;
            on.beginPath();
            for (const place of places) on.lineTo(.../** @type {[number, number]} */ (place));
            on.fill();
        }
        line([...square, square[0]], "#ffd166", 2);
        const far = hit ? hit.position : add(ray.origin, times(3 * this.camera.size(), ray.direction));
        line([ray.origin, far], "#ffd166", 2);
        const end = hit && second.pixelOf(far, rows, columns);
        if (!end) return;
        on.fillStyle = "#ffd166";
        on.beginPath();
        on.arc(end[0], end[1], 4, 0, 2 * Math.PI);
        on.fill();
        on.font = "13px system-ui, sans-serif";
        on.fillText(`t = ${Number(hit.t.toPrecision(5))}`, end[0] + 8, end[1] + 4);
    }

    /** A picture of the scene for the second camera; one at a time. */
    async #ask() {
        if (this.isAsking || !this.second) return;
        this.isAsking = true;
        this.isStale = false;
        try {
            const camera = this.second.flat(300, 400);
            const request = { ...this.request(), camera, channel: "color", samples: 1, is_lit: false, edges: 0 };
            request.part = { ...request.part, cut: null };
            const { image } = await this.engine.frame(request, new AbortController().signal);
            this.behind?.close();
            this.behind = image ?? null;
        } catch {
            // The drawing does without; the page's own picture says what is wrong.
        } finally {
            this.isAsking = false;
        }
        this.draw();
    }

    /** @param {any} canvas */
    #handle(canvas) {
        canvas.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => canvas.setPointerCapture(event.pointerId));
        canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => {
            if ((event.buttons & 1) === 0 || !this.second) return;
            this.second.orbit(event.movementX / 150, event.movementY / 150);
            this.isStale = true;
            this.draw();
        });
        canvas.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
            const way = /** @type {Record<string, number[]>} */ ({ ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] })[event.key];
            if (!way || !this.second) return;
            event.preventDefault();
            event.stopPropagation();
            this.second.orbit(0.1 * way[0], -0.1 * way[1]);
            this.isStale = true;
            this.draw();
        });
        canvas.addEventListener(
            "wheel",
            (/** @type {WheelEvent} */ event) => {
                event.preventDefault();
                this.second?.zoom(Math.exp(0.0015 * event.deltaY), 0, 0);
                this.isStale = true;
                this.draw();
            },
            { passive: false },
        );
    }
}
