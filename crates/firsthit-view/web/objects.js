// @ts-check
// The list of objects: which are there, in which colours, and what the pointer is on.

import { disable, element, hex, linearColor, make, named, plain } from "./dom.js";

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
        this.#showColors();
        element("show-all").addEventListener("click", () => this.show(() => true));
        element("own-colors").addEventListener("click", () => {
            this.colors.clear();
            this.#showColors();
            this.changed();
        });
        element("filter-objects").addEventListener("input", () => {
            const wanted = element("filter-objects").value.toLowerCase();
            for (const line of lines) line.hidden = !line.querySelector("span").textContent.toLowerCase().includes(wanted);
        });
    }

    /** @param {any} object */
    #line(object) {
        const line = make("li");
        const label = make("label");
        const box = make("input", "", { type: "checkbox" });
        box.checked = !this.hidden.has(object.object);
        label.append(box, make("span", plain(object.name || object.shape)));
        const size = make("small", object.triangles ? object.triangles.toLocaleString("en") : "–");
        const color = make("input", "", { type: "color", "aria-label": `colour of ${named(object)}` });
        const own = hex(object.color);
        color.value = own;
        this.swatches.set(object.object, { field: color, own });
        color.addEventListener("input", () => this.#color(object.object, color.value));
        const alone = make("button", "only", { "aria-label": `show only ${named(object)}` });
        line.append(label, make("small", String(object.object)), size, color, alone);
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
        this.colors.set(object, linearColor(color));
        this.#showColors();
        this.changed();
    }

    /** The fields show the colours that objects have. */
    #showColors() {
        for (const [object, { field, own }] of this.swatches) {
            const given = this.colors.get(object);
            field.value = given ? hex(given) : own;
        }
        disable("own-colors", this.colors.size === 0 && "All objects have the scene's colours.");
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
