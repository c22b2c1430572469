// @ts-check
// The section plane: along an axis or across the view, at a place between the ends of the scene.

import { add, dot, times, unit } from "./camera.js";
import { element, restoreFields, savedFields } from "./dom.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").Cut} Cut */

export class CutPlane {
    /** @param {[Vector, Vector] | null} bounds @param {() => Vector} aim of the camera @param {() => void} changed */
    constructor(bounds, aim, changed) {
        this.bounds = bounds ?? [[-1, -1, -1], [1, 1, 1]];
        /** @type {Vector} */
        this.normal = [1, 0, 0];
        const axes = /** @type {Record<string, Vector>} */ ({ x: [1, 0, 0], y: [0, 1, 0], z: [0, 0, 1] });
        /** The plane's points have this scalar product with the normal. */
        this.offset = 0;
        element("cut-axis").addEventListener("change", () => {
            const name = element("cut-axis").value;
            this.normal = axes[name] ?? unit(times(-1, aim()));
            // The camera's side is the one that goes.
            element("cut-turned").checked = dot(this.normal, aim()) > 0;
            this.#slide();
            changed();
        });
        element("cut-place").addEventListener("input", () => {
            this.#slide();
            changed();
        });
        element("cut-offset").addEventListener("change", () => {
            const offset = Number(element("cut-offset").value);
            const isGood = element("cut-offset").value.trim() !== "" && Number.isFinite(offset);
            element("cut-offset").setAttribute("aria-invalid", String(!isGood));
            if (!isGood) return;
            this.offset = offset;
            const [middle, reach] = this.#extent();
            element("cut-place").value = String(0.5 + (offset - middle) / (2 * reach || 1));
            changed();
        });
        element("cut-turned").addEventListener("input", changed);
    }

    saved() {
        const { normal, offset } = this;
        return { normal, offset, fields: savedFields(["cut-axis", "cut-place", "cut-turned", "cut-offset"]) };
    }

    /** @param {{normal: Vector, offset: number, fields: Record<string, string | boolean>}} saved */
    restore({ normal, offset, fields }) {
        [this.normal, this.offset] = [normal, offset];
        restoreFields(fields);
    }

    /** The box along the normal: its middle, and how far it reaches from there. @returns {[number, number]} */
    #extent() {
        const [low, high] = this.bounds;
        const reach = this.normal.reduce((sum, x, axis) => sum + (Math.abs(x) * (high[axis] - low[axis])) / 2, 0);
        return [dot(this.normal, times(0.5, add(low, high))), reach];
    }

    /** Takes the place of the slider. */
    #slide() {
        const [middle, reach] = this.#extent();
        this.offset = middle + (2 * Number(element("cut-place").value) - 1) * reach;
        // As many digits as tell places of the slider apart.
        element("cut-offset").value = String(Number(this.offset.toPrecision(12)));
    }

    /** @returns {Cut | null} */
    plane() {
        if (element("cut-axis").value === "none") return null;
        const { normal, offset } = this;
        return element("cut-turned").checked ? { normal: times(-1, normal), offset: -offset } : { normal, offset };
    }
}
