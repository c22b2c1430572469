// @ts-check
// The section plane: along an axis or across the view, at a place between the ends of the scene; its faces, and their areas.

import { add, dot, times, unit } from "./camera.js";
import { download, element, linearColor, named, restoreFields, savedFields, words } from "./dom.js";
import { readOut } from "./readout.js";
import { say } from "./status.js";

/** @typedef {import("./camera.js").Vector} Vector */
/** @typedef {import("./engine.js").Cut} Cut */

/** So many faces are listed. */
const MOST_FACES = 100;

export class CutPlane {
    /** What the faces were last measured of. */
    #measured = "";

    /** @param {import("./engine.js").Engine} engine measures the faces @param {[Vector, Vector] | null} bounds @param {() => Vector} aim of the camera @param {() => import("./engine.js").Visibility} part what is seen @param {() => void} changed */
    constructor(engine, bounds, aim, part, changed) {
        this.engine = engine;
        this.part = part;
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
            this.#showFields();
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
        for (const id of ["cut-turned", "cut-own"]) element(id).addEventListener("input", changed);
        element("cut-color").addEventListener("input", () => {
            element("cut-own").checked = false;
            changed();
        });
        element("save-svg").addEventListener("click", async () => {
            try {
                const { svg } = await this.engine.section(this.part(), true);
                download("section.svg", new Blob([svg], { type: "image/svg+xml" }));
            } catch (error) {
                say(words(error), true);
            }
        });
    }

    saved() {
        const { normal, offset } = this;
        return { normal, offset, fields: savedFields(["cut-axis", "cut-place", "cut-turned", "cut-offset", "cut-color", "cut-own"]) };
    }

    /** @param {{normal: Vector, offset: number, fields: Record<string, string | boolean>}} saved */
    restore({ normal, offset, fields }) {
        [this.normal, this.offset] = [normal, offset];
        restoreFields(fields);
        this.#showFields();
    }

    #showFields() {
        element("cut-fields").hidden = this.plane() === null;
        if (this.plane() === null) element("faces-label").hidden = true;
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

    /** The colour of the faces, which is linear; null: each has its object's. */
    color() {
        return this.plane() === null || element("cut-own").checked ? null : linearColor(element("cut-color").value);
    }

    /** Measures the faces, if they are others than before. */
    async measure() {
        const part = this.part();
        const asked = JSON.stringify(part);
        if (!part.cut || asked === this.#measured) return;
        const { area, faces, warnings } = await this.engine.section(part, false);
        this.#measured = asked;
        element("faces-label").hidden = this.plane() === null;
        const group = [area];
        const listed = faces.slice(0, MOST_FACES).map((/** @type {any} */ face) => {
            const name = named(face);
            return face.area === null ? { name, text: "open: no area" } : { name, numbers: [face.area], group };
        });
        readOut(element("faces"), [{ name: "area of all faces", numbers: group }, ...listed]);
        const more = faces.length - listed.length;
        const notes = [more > 0 ? `... and ${more.toLocaleString("en")} more.` : "", ...warnings];
        element("faces-note").textContent = notes.filter((note) => note !== "").join(" ");
    }
}
