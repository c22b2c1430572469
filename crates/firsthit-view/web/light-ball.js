// @ts-check
// A ball that says where a sun stands, as seen from the camera: dragged, or moved by arrows.

import { add, times } from "./camera.js";
import { element } from "./dom.js";

/** @typedef {import("./camera.js").Vector} Vector */

export class LightBall {
    /** @param {() => {right: Vector, up: Vector, aim: Vector}} axes of the camera @param {() => void} changed */
    constructor(axes, changed) {
        this.axes = axes;
        /** Where the sun stands on the ball, to the right and upwards, at most 1 from its middle. */
        this.x = -0.4;
        this.y = 0.6;
        /** Where its light goes, in the world; null while nobody has moved it. @type {Vector | null} */
        this.direction = null;
        const ball = element("ball");
        const move = (/** @type {number} */ x, /** @type {number} */ y) => {
            const far = Math.max(1, Math.hypot(x, y) / 0.98);
            [this.x, this.y] = [x / far, y / far];
            this.#aim();
            changed();
        };
        const take = (/** @type {PointerEvent} */ event) => {
            const box = ball.getBoundingClientRect();
            move((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
        };
        ball.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => {
            ball.setPointerCapture(event.pointerId);
            take(event);
        });
        ball.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => {
            if (event.buttons & 1) take(event);
        });
        ball.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
            const way = /** @type {Record<string, number[]>} */ ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] })[event.key];
            if (!way) return;
            event.preventDefault();
            event.stopPropagation();
            move(this.x + 0.08 * way[0], this.y + 0.08 * way[1]);
        });
        this.draw();
    }

    /** The light's direction is fixed in the world from now on. */
    #aim() {
        const { right, up, aim } = this.axes();
        const towards = Math.sqrt(Math.max(0, 1 - this.x ** 2 - this.y ** 2));
        const sun = add(add(times(this.x, right), times(this.y, up)), times(-towards, aim));
        this.direction = times(-1, sun);
        this.draw();
    }

    /** The sun stands where the ball has it. */
    shine() {
        this.#aim();
    }

    /** No sun any more. */
    clear() {
        this.direction = null;
        this.draw();
    }

    saved() {
        const { x, y, direction } = this;
        return { x, y, direction };
    }

    /** @param {{x: number, y: number, direction: Vector | null}} saved */
    restore(saved) {
        Object.assign(this, saved);
        this.draw();
    }

    draw() {
        const percent = (/** @type {number} */ x) => `${Math.round(100 * Math.abs(x))} percent`;
        const words = `${percent(this.x)} ${this.x < 0 ? "left" : "right"}, ${percent(this.y)} ${this.y < 0 ? "down" : "up"}`;
        element("ball").setAttribute("aria-valuetext", this.direction ? words : "no sun");
        element("ball").setAttribute("aria-valuenow", String(Math.round(100 * this.x)));
        const canvas = element("ball");
        const on = canvas.getContext("2d");
        const radius = canvas.width / 2;
        const [x, y] = [radius * (1 + this.x), radius * (1 - this.y)];
        const shine = on.createRadialGradient(x, y, 2, x, y, 1.6 * radius);
        shine.addColorStop(0, this.direction ? "#fff6d8" : "#9aa7b5");
        shine.addColorStop(1, "#2b3440");
        on.clearRect(0, 0, canvas.width, canvas.height);
        on.fillStyle = shine;
        on.beginPath();
        on.arc(radius, radius, radius - 1, 0, 2 * Math.PI);
        on.fill();
    }
}
