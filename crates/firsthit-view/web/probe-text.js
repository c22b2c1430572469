// @ts-check
// What a pixel shows, and what lies between hits, in lines.

import { plain, six, vector } from "./dom.js";

/** @typedef {[number, number, number]} Vector */

/** @param {any} probed @returns {string} */
export function probeText(probed) {
    const { pixel, hit, cut_face: face } = probed;
    const lines = [`pixel      ${pixel.column}, ${pixel.row}`];
    if (!hit) return [...lines, "hit        none"].join("\n");
    if (face) {
        lines.push(
            `cut face   ${face.object} ${plain(face.name || face.shape)}`,
            `t          ${face.t}`,
            `position   ${face.position.join(", ")}`,
            `normal     ${vector(face.normal)}`,
            "inside, behind the cut face:",
        );
    }
    lines.push(
        `t          ${hit.t}`,
        `range, z   ${six(pixel.range)}, ${six(pixel.z)}`,
        `object     ${hit.object} ${plain(hit.name || hit.shape)}`,
        `primitive  ${hit.primitive}`,
        `position   ${hit.position.join(", ")}`,
        `normal     ${vector(hit.normal)}, ${hit.front ? "front" : "back"}`,
    );
    if (hit.node) lines.push(`node       ${hit.node.id} ${plain(hit.node.name)}`);
    if (hit.material) lines.push(`material   ${plain(String(hit.material.name || hit.material.id))}`);
    return lines.join("\n");
}

/** Distances along a path of hits, and of two the difference and the angle. @param {any[]} hits @returns {string} */
export function measured(hits) {
    const steps = hits.slice(1).map((hit, k) => minus(hit.position, hits[k].position));
    const lengths = steps.map((step) => Math.hypot(...step));
    if (steps.length === 0) return "";
    if (steps.length === 1) {
        const [a, b] = hits;
        return [
            `distance   ${lengths[0]}`,
            `difference ${vector(steps[0])}`,
            `angle      ${six(degrees(a.normal, b.normal))} degrees between normals`,
        ].join("\n");
    }
    const lines = lengths.map((length, k) => `${k + 1} to ${k + 2}     ${length}`);
    lines.push(`path       ${lengths.reduce((sum, length) => sum + length, 0)}`);
    if (hits.length === 3) {
        const back = minus(hits[0].position, hits[1].position);
        lines.push(`angle      ${six(degrees(back, steps[1]))} degrees at 2`);
    }
    return lines.join("\n");
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
