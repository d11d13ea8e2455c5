import { render } from "preact";
import { Layout } from "./layout/layout";
import { createStudio } from "./studio";

const root = document.getElementById("app");
if (root) {
    const studio = createStudio();
    Object.assign(globalThis, { coppice: studio }); // for the console, and tests
    render(<Layout studio={studio} />, root);
}
