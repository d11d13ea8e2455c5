import { render } from "preact";
import { Layout } from "./layout/layout";
import { createStudio, type Studio } from "./studio";

function createOrSay(root: HTMLElement): Studio | null {
    try {
        return createStudio();
    } catch (error) {
        const why = (error as Error).message;
        render(
            <p
                class="error"
                role="alert"
            >{`The studio cannot start here: ${why} It draws with WebGL 2; allow that in the browser's settings, or use another browser.`}</p>,
            root,
        );
        return null;
    }
}

const root = document.getElementById("app");
const studio = root && createOrSay(root);
if (root && studio) {
    Object.assign(globalThis, { coppice: studio }); // for the console, and tests
    render(<Layout studio={studio} />, root);
}
