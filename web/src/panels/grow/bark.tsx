// The bark of a surface: a material of the scene, which its line uses.
import type { App } from "../../app";
import type { Command, State } from "../../protocol";
import { placesIn } from "../../script/names";
import { lineOf, readCall, type Values } from "../../script/values";
import { documentText } from "../../tools/kit/source";
import { tracked } from "../../use";
import type { Card, ObjectStatement } from "./card";
import { commandNamed } from "./values";

const kCreators = ["material", "loadmaterial"];

/** The statement that creates the material of a surface; null if it has no material, or another statement creates it. */
function materialOf(state: State, schema: readonly Command[], { values, bound }: ObjectStatement): ObjectStatement | null {
    const name = values.material?.[0];
    const commands = schema.filter((command) => kCreators.includes(command.name));
    for (let i = bound.statement - 1; name !== undefined && i >= 0; --i) {
        const call = readCall(commands, state.statements[i].text);
        if (call?.values.name?.[0] === name) {
            return { command: call.command, values: call.values, bound: { statement: i, text: state.statements[i].text, comment: call.comment } };
        }
    }
    return null;
}

/** Returns whether other statements than that of the surface use its material. */
function isShared(state: State, schema: readonly Command[], { values, bound }: ObjectStatement): boolean {
    const name = values.material?.[0] ?? "";
    return state.statements.some(
        ({ text }, i) =>
            i !== bound.statement && placesIn(schema, text).some((place) => place.name === name && place.role !== "makes" && place.kinds.includes("material")),
    );
}

function withoutBark(values: Values): Values {
    return Object.fromEntries(Object.entries(values).filter(([name]) => name !== "material" && name !== "uv" && !name.startsWith("displace")));
}

/** The text of the document in which a surface has the bark of a species; without bark for an empty name. `free` is an unused name. */
export function withBark(state: State, schema: readonly Command[], surface: ObjectStatement, species: string, free: string): string {
    const { command, values, bound } = surface;
    const material = materialOf(state, schema, surface);
    const own = material?.command.name === "material" && !isShared(state, schema, surface) ? material : null;
    if (own && species !== "") {
        const line = lineOf(own.command, { ...own.values, species: [species] }, own.bound.comment);
        return documentText(state, new Map([[own.bound.statement, line]]));
    }
    const changes = new Map<number, string | null>();
    if (species === "") {
        changes.set(bound.statement, lineOf(command, withoutBark(values), bound.comment));
        if (own) {
            changes.set(own.bound.statement, null);
        }
    } else {
        const line = lineOf(command, { ...values, uv: ["bark"], material: [free] }, bound.comment);
        changes.set(bound.statement, `material ${free} ${species}\n${line}`);
    }
    return documentText(state, changes);
}

async function setBark(app: App, surface: ObjectStatement, species: string): Promise<void> {
    const state = app.store.state.peek();
    const text = withBark(state, app.store.schema.peek(), surface, species, app.store.freeName("bark"));
    try {
        await app.engine.request("text", { text, revision: state.revision, name: species === "" ? "no bark" : `bark of ${species}` });
    } catch (error) {
        app.store.notify((error as Error).message, "error");
    }
}

/** Selects the bark of the surface that the card changes. */
export const BarkField = tracked(({ card }: { card: Card }) => {
    const { app } = card;
    const schema = app.store.schema.value;
    const command = card.schema;
    const bound = card.bound.value;
    const species = commandNamed(schema, "material")?.arguments.find(({ name }) => name === "species")?.choices ?? [];
    if (!command || !bound || species.length === 0) {
        return null;
    }
    const surface = { command, values: card.values.value, bound };
    const name = surface.values.material?.[0];
    const made = materialOf(app.store.state.value, schema, surface)?.values.species?.[0];
    const other = name !== undefined && made === undefined ? name : null; // images in files
    return (
        <label class="tool-field">
            <span>Bark</span>
            <select
                value={other === null ? (made ?? "") : `=${other}`}
                disabled={card.busy.value}
                onChange={(event) => void setBark(app, surface, event.currentTarget.value)}
            >
                <option value="">none</option>
                {other !== null && <option value={`=${other}`}>{`images of ${other}`}</option>}
                {species.map((one) => (
                    <option key={one} value={one}>
                        {one}
                    </option>
                ))}
            </select>
        </label>
    );
});
