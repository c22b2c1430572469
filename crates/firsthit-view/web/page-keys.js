// @ts-check
// What the keys of the page do.

import { element } from "./dom.js";
import { arrow, listKeys, press } from "./keys.js";

/** @param {import("./page.js").Page} page @param {AbortSignal} ended */
export function connectKeys(page, ended) {
    const { camera, objects } = page;
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
            page.showProjection();
            page.moved();
        } },
        o: { about: "orthographic or perspective", act: click("orthographic") },
        g: { about: "ground: as rendered, with, without", act: next("ground") },
        e: { about: "edges", act: click("edges") },
        t: { about: "turn by itself", act: () => page.turn() },
        c: { about: "next channel", act: next("channel") },
        d: { about: "all digits, or those that a person reads", act: click("digits") },
        h: { about: "hide the object under the pointer", act: () => {
            const { hit } = page.pointed ?? {};
            if (hit) objects.show((object) => object !== hit.object && !objects.hidden.has(object));
        } },
        u: { about: "undo the last mark, or bring back those that were cleared", act: click("undo") },
        Escape: { about: "clear marks", act: click("clear") },
        Enter: { about: "keep the point in the picture's middle", act: () => {
            const [rows, columns] = page.view.shape;
            /** @type {[number, number]} */
            const middle = [rows >> 1, columns >> 1];
            page.point(middle);
            page.keep(middle);
        } },
        "?": { about: "this list", act: click("help") },
    };
    page.standardViews.forEach((one, k) => (keys[k + 1] = { about: `${one.name} view`, act: () => page.lookAlong(one) }));
    listKeys(keys);
    addEventListener("keydown", (event) => press(event, keys, (key, isShifted) => steer(page, key, isShifted)), { signal: ended });
}

/** Moves the camera by a key; says whether it is one for that. @param {import("./page.js").Page} page @param {string} key @param {boolean} isShifted */
function steer(page, key, isShifted) {
    const { camera } = page;
    const way = arrow(key);
    const nearer = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 }[key];
    if (way && isShifted) camera.pan(-0.05 * way[0], 0.05 * way[1]);
    else if (way) camera.orbit(-0.1 * way[0], -0.1 * way[1]);
    else if (nearer) camera.zoom(nearer, 0, 0);
    else return false;
    page.moved();
    return true;
}
