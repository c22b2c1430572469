// @ts-check
// What a pixel shows, and what lies between hits, in rows.

import { named, plain } from "./dom.js";
import { unknown } from "./readout.js";

/** @typedef {import("./readout.js").Row} Row */

const NONE = "–";

/** The rows of a probed pixel. There are as many for a miss, and where nothing was pointed at, so that nothing jumps. @param {any} probed @param {boolean} isCut whether there is a section plane @returns {Row[]} */
export function probeRows(probed, isCut) {
    const { pixel, hit, cut_face: face, node, material } = { ...probed, ...probed?.hit };
    const group = hit ? [hit.t, pixel.range, pixel.z].map(Number) : unknown(3);
    /** @type {Row[]} */
    const rows = [{ name: "pixel", text: pixel ? `(${pixel.row}, ${pixel.column})` : NONE }];
    if (isCut) {
        rows.push(
            { name: "cut face", text: face ? named(face) : NONE },
            ...numbers({ t: [face?.t ?? NaN], position: face?.position ?? unknown(3) }),
            { name: "behind it", text: "" },
        );
    }
    return [
        ...rows,
        { name: "object", text: hit ? named(hit) : pixel ? "none: the ray meets nothing" : NONE },
        { name: "node", text: node ? `${plain(node.name)} (${node.id})` : NONE },
        { name: "material", text: material ? plain(String(material.name || material.id)) : NONE },
        { name: "primitive", text: hit ? `${hit.primitive}, its ${hit.front ? "front" : "back"}` : NONE },
        ...["t", "range", "z"].map((name, k) => ({ name, numbers: [group[k]], group })),
        ...numbers({ position: hit?.position ?? unknown(3), normal: hit?.normal ?? unknown(3) }),
    ];
}

/** @param {Record<string, number[]>} all @returns {Row[]} */
const numbers = (all) => Object.entries(all).map(([name, numbers]) => ({ name, numbers }));

/** Distances along a path of hits, and of two the difference and the angle. @param {any[]} hits @returns {Row[]} */
export function measured(hits) {
    const steps = hits.slice(1).map((hit, k) => minus(hit.position, hits[k].position));
    const lengths = steps.map((step) => Math.hypot(...step));
    if (steps.length === 0) return [];
    if (steps.length === 1) {
        const angle = degrees(hits[0].normal, hits[1].normal);
        return numbers({ distance: lengths, difference: steps[0], "angle of normals, in degrees": [angle] });
    }
    const path = lengths.reduce((sum, length) => sum + length, 0);
    const group = [...lengths, path];
    const rows = lengths.map((length, k) => /** @type {Row} */ ({ name: `${k + 1} to ${k + 2}`, numbers: [length], group }));
    rows.push({ name: "path", numbers: [path], group });
    if (hits.length === 3) {
        const back = minus(hits[0].position, hits[1].position);
        rows.push(...numbers({ "angle at 2, in degrees": [degrees(back, steps[1])] }));
    }
    return rows;
}

/** @param {number[]} a @param {number[]} b */
const minus = (a, b) => a.map((x, axis) => x - b[axis]);

/** The angle between two vectors, by Kahan's formula, which is exact near 0 and 180 too. @param {number[]} a @param {number[]} b */
function degrees(a, b) {
    const [p, q] = [Math.hypot(...a), Math.hypot(...b)];
    const [u, v] = [a.map((x) => x * q), b.map((x) => x * p)];
    const apart = Math.hypot(...minus(u, v));
    const together = Math.hypot(...u.map((x, axis) => x + v[axis]));
    return (360 / Math.PI) * Math.atan2(apart, together);
}
