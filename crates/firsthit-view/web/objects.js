// @ts-check
// The list of objects: which are there, in which colours, and what the pointer is on.

import { element, make, plain } from "./dom.js";

/** A linear colour as "#rrggbb" in sRGB. @param {number[]} color */
const hex = (color) => `#${color.map((part) => Math.round(255 * encoded(Math.max(0, Math.min(1, part)))).toString(16).padStart(2, "0")).join("")}`;
/** @param {number} part from 0 to 1 */
const encoded = (part) => (part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055);
/** The linear part of a colour in sRGB (IEC 61966-2-1). @param {number} part from 0 to 1 */
const linear = (part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);

export class Objects {
    /** @param {any} info @param {() => void} changed */
    constructor(info, changed) {
        /** @type {Set<number>} */
        this.hidden = new Set(info.hidden);
        /** Those that the scene itself hides. */
        this.usual = new Set(info.hidden);
        this.changed = changed;
        this.count = info.object_count;
        /** Objects that were given a colour, which is linear. @type {Map<number, number[]>} */
        this.colors = new Map();
        /** @type {Map<number, any>} */
        this.boxes = new Map();
        /** The field of each colour, and what it shows where the object has the scene's. @type {Map<number, {field: any, own: string}>} */
        this.swatches = new Map();
        /** @type {any} */
        this.marked = null;
        const lines = info.objects.map((/** @type {any} */ object) => this.#line(object));
        element("objects").replaceChildren(...lines);
        const more = info.object_count - info.objects.length;
        element("more-objects").textContent = more > 0 ? `... and ${more.toLocaleString("en")} more` : "";
        element("show-all").addEventListener("click", () => this.show(() => true));
        element("own-colors").addEventListener("click", () => {
            this.colors.clear();
            this.#showColors();
            this.changed();
        });
        element("filter-objects").addEventListener("input", () => {
            const wanted = element("filter-objects").value.toLowerCase();
            for (const line of lines) line.hidden = !line.textContent.toLowerCase().includes(wanted);
        });
    }

    /** @param {any} object */
    #line(object) {
        const line = make("li", "", { value: String(object.object) });
        const label = make("label");
        const box = make("input", "", { type: "checkbox" });
        box.checked = !this.hidden.has(object.object);
        const triangles = object.triangles ? ` ${object.triangles.toLocaleString("en")}` : "";
        label.append(box, make("span", plain(object.name || object.shape)), triangles);
        const color = make("input", "", { type: "color", "aria-label": `colour of ${plain(object.name || object.shape)} ${object.object}` });
        const own = hex(object.color);
        color.value = own;
        this.swatches.set(object.object, { field: color, own });
        color.addEventListener("input", () => this.#color(object.object, color.value));
        const alone = make("button", "only", { "aria-label": `show only ${plain(object.name || object.shape)} ${object.object}` });
        line.append(label, color, alone);
        this.boxes.set(object.object, box);
        box.addEventListener("change", () => {
            if (box.checked) this.hidden.delete(object.object);
            else this.hidden.add(object.object);
            this.changed();
        });
        alone.addEventListener("click", () => this.show((other) => other === object.object));
        return line;
    }

    /** @param {number} object @param {string} color as "#rrggbb" */
    #color(object, color) {
        this.colors.set(object, [1, 3, 5].map((at) => linear(parseInt(color.slice(at, at + 2), 16) / 255)));
        element("own-colors").disabled = false;
        this.changed();
    }

    /** The fields show the colours that objects have. */
    #showColors() {
        for (const [object, { field, own }] of this.swatches) {
            const given = this.colors.get(object);
            field.value = given ? hex(given) : own;
        }
        element("own-colors").disabled = this.colors.size === 0;
    }

    saved() {
        return { hidden: [...this.hidden], colors: [...this.colors] };
    }

    /** @param {{hidden: number[], colors: [number, number[]][]}} saved */
    restore({ hidden, colors }) {
        this.hidden = new Set(hidden);
        this.colors = new Map(colors);
        for (const [object, box] of this.boxes) box.checked = !this.hidden.has(object);
        this.#showColors();
    }

    /** Shows the objects that are wanted, and no others. @param {(object: number) => boolean} isWanted */
    show(isWanted) {
        for (let object = 0; object < this.count; object++) {
            if (isWanted(object)) this.hidden.delete(object);
            else this.hidden.add(object);
        }
        for (const [object, box] of this.boxes) box.checked = !this.hidden.has(object);
        this.changed();
    }

    /** What to ask for: the shorter of the two lists, or neither where all is as the scene has it. @returns {{hidden: number[] | null, only: number[] | null}} */
    asked() {
        const { hidden, usual, count } = this;
        if (hidden.size === usual.size && [...hidden].every((object) => usual.has(object))) return { hidden: null, only: null };
        if (hidden.size <= count / 2) return { hidden: [...hidden], only: null };
        const only = [];
        for (let object = 0; object < count; object++) if (!hidden.has(object)) only.push(object);
        return { hidden: null, only };
    }

    /** Marks the object under the pointer. @param {number | null} object */
    point(object) {
        this.marked?.removeAttribute("aria-current");
        this.marked = object === null ? null : this.boxes.get(object)?.closest("li");
        this.marked?.setAttribute("aria-current", "true");
    }
}
