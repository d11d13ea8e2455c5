// Runs a file of browser tests, and once more where it fails: on a machine that has other work to do, a browser may lose what a hand did.
// What fails both times has failed; what failed the first time is told in any case.
import { spawnSync } from "node:child_process";

const [file] = process.argv.slice(2);
const run = () => spawnSync(process.execPath, ["--test", file], { stdio: "inherit" }).status ?? 1;
let status = run();
if (status !== 0) {
    console.log(`${file} failed, and is run once more.`);
    status = run();
}
process.exitCode = status;
