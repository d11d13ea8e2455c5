// Rules of ESLint for the page and its tests; Prettier formats, and tsc finds unused names.
import { defineConfig } from "eslint/config";
import tseslint from "typescript-eslint";

export default defineConfig(tseslint.configs.recommended, {
    rules: {
        // `const { removed: _, ...rest }` copies an object without a property.
        "@typescript-eslint/no-unused-vars": ["error", { ignoreRestSiblings: true }],
    },
});
