// @ts-check
// The light that was chosen: sets of lights, a sun that a ball moves, and light from all around.

import { add, dot, length, times, unit } from "./camera.js";
import { element, offer } from "./dom.js";
import { LightBall } from "./light-ball.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").EnvironmentRequest} EnvironmentRequest */

const AS_RENDERED = "as rendered";
const SUN = "a sun: the ball";
/** The choices of the light from all around, and what engines call them. */
const ENVIRONMENTS = /** @type {Record<string, "own" | "none" | "daylight">} */ ({ "the scene's": "own", none: "none", "clear sky": "daylight" });
/** The sine of the height of a sky's sun, at least. */
const LOWEST_SUN = 0.02;

export class Lighting {
    /** @param {any} info @param {import("./camera.js").OrbitCamera} camera @param {() => void} changed */
    constructor(info, camera, changed) {
        this.info = info;
        this.camera = camera;
        offer("light", [AS_RENDERED, SUN, ...info.lights]);
        const environments = Object.keys(ENVIRONMENTS).filter((name) => info.environment || ENVIRONMENTS[name] === "daylight");
        offer("environment", [AS_RENDERED, ...environments]);
        const axes = () => ({ right: camera.axes()[0], up: camera.axes()[1], aim: unit(camera.aim) });
        this.ball = new LightBall(axes, () => {
            if (element("environment").value !== "clear sky") element("light").value = SUN;
            changed();
        });
        element("light").addEventListener("change", () => {
            if (element("light").value === SUN) this.ball.shine();
            else this.ball.clear();
            changed();
        });
        for (const id of ["environment", "environment-strength", "environment-turn"]) {
            element(id).addEventListener("change", () => {
                this.showFields();
                changed();
            });
        }
    }

    /** Shows the fields that the light from all around has. */
    showFields() {
        element("environment-label").hidden = !["own", "daylight"].includes(ENVIRONMENTS[element("environment").value]);
    }

    /** What to ask for. @returns {{light: string | null, sun: Vector | null, environment: EnvironmentRequest | null}} */
    asked() {
        const { ball: { direction }, info } = this;
        const light = element("light").value;
        const environment = this.#environment();
        const isOfSky = environment?.choice === "daylight";
        const sun = direction && (light === SUN || isOfSky) ? this.#sun(direction, isOfSky) : null;
        return { light: info.lights.includes(light) ? light : null, sun, environment };
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
}
