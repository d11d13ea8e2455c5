// Rules of ESLint for the page and its tests; Prettier formats, and tsc finds unused names.
import { defineConfig } from "eslint/config";
import tseslint from "typescript-eslint";

export default defineConfig(tseslint.configs.recommended);
