// Runs a file of browser tests, and repeats it after a failure: on a busy machine, a browser may lose input events. A test fails
// if both runs fail; the first failure is reported in any case.
import { spawnSync } from "node:child_process";

const [file] = process.argv.slice(2);
const run = () => spawnSync(process.execPath, ["--test", file], { stdio: "inherit" }).status ?? 1;
let status = run();
if (status !== 0) {
    console.log(`${file} failed, and is repeated.`);
    status = run();
}
process.exitCode = status;
