// @ts-check
// What is shown, beside the camera, as options of the command line; and what those cannot say.

/** @typedef {import("./engine.js").FrameRequest} FrameRequest */

/**
 * The options that make the program show what the page does, and the things for which there are none.
 * @param {FrameRequest} request what the page asks for
 * @param {any} info what the engine has
 * @returns {{options: string[], missing: string[]}}
 */
export function lookText({ light, sun, environment, colors, ground, edges, part }, info) {
    const names = info.objects.map((/** @type {any} */ object) => object.name);
    const options = [];
    if (light) options.push(`--light ${light}`);
    if (ground !== null) options.push(ground ? "--ground" : "--no-ground");
    if (!part.cut && edges !== (info.edges ?? 0)) options.push(edges ? `--edges ${edges}` : "--no-edges");
    const picked = part.only ?? part.hidden ?? [];
    for (const object of picked) options.push(`${part.only ? "--only" : "--hide"} ${object}`);
    const missing = /** @type {[string, boolean][]} */ ([
        ["the sun", sun !== null],
        ["the light from all around", environment !== null],
        ["colours of objects", colors.length > 0],
        ["the section plane", part.cut !== null],
        ["that all objects are hidden", part.only?.length === 0],
        // The program would take the number for that name.
        ["which objects are hidden", picked.some((object) => names.includes(String(object)))],
    ]);
    return { options, missing: missing.filter(([, isMissing]) => isMissing).map(([name]) => name) };
}
