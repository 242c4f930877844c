// Starts `rtscript lsp` and offers its commands. All that is known of the language is known by that program.
"use strict";

const path = require("node:path");
const { commands, window, workspace, RelativePattern, Uri, ViewColumn } = require("vscode");
const { LanguageClient } = require("vscode-languageclient/node");

let client;
const terminals = new Map();

function settings() {
  return workspace.getConfiguration("rtscript");
}

async function start() {
  const command = settings().get("path", "rtscript");
  const program = { command, args: ["lsp"] };
  client = new LanguageClient("rtscript", "rtscript", program, {
    documentSelector: [
      { scheme: "file", language: "rtscript" },
      { scheme: "untitled", language: "rtscript" },
    ],
    synchronize: { fileEvents: workspace.createFileSystemWatcher("**/*.{rhai,obj,mtl,png,jpg,jpeg}") },
  });
  try {
    await client.start();
  } catch (error) {
    client = undefined;
    const open = "Open settings";
    const message = `rtscript: '${command} lsp' does not start (${error.message}). The setting rtscript.path says where the program is.`;
    if ((await window.showErrorMessage(message, open)) === open) {
      await commands.executeCommand("workbench.action.openSettings", "rtscript.path");
    }
  }
}

async function restart() {
  await client?.stop();
  client = undefined;
  await start();
}

// An argument as every shell takes it: without its special characters there is nothing to quote.
function quoted(argument) {
  if (/^[\w./:=@%+,-]+$/.test(argument)) {
    return argument;
  }
  return process.platform === "win32" ? `"${argument.replaceAll('"', '""')}"` : `'${argument.replaceAll("'", "'\\''")}'`;
}

// Runs a command of the program on the script at hand, in a terminal, and shows the picture that it writes beside it.
async function run(verb, more) {
  const document = window.activeTextEditor?.document;
  if (document?.uri.scheme !== "file") {
    await window.showInformationMessage("Save the script first: its picture is written beside it.");
    return;
  }
  await document.save();
  const folder = path.dirname(document.fileName);
  const scene = path.basename(document.fileName);
  const picture = `${path.basename(scene, path.extname(scene))}.png`;
  const line = [settings().get("path", "rtscript"), verb, scene, "-o", picture, ...more];
  const terminal = window.createTerminal({ name: `rtscript ${verb} ${scene}`, cwd: folder });
  terminals.get(verb)?.dispose();
  terminals.set(verb, terminal);
  terminal.show(true);
  terminal.sendText(line.map(quoted).join(" "));
  // The editor shows a picture anew by itself when its file changes.
  const shown = Uri.file(path.join(folder, picture));
  const watcher = workspace.createFileSystemWatcher(new RelativePattern(Uri.file(folder), picture));
  const open = async () => {
    watcher.dispose();
    await commands.executeCommand("vscode.open", shown, { viewColumn: ViewColumn.Beside, preserveFocus: true });
  };
  watcher.onDidCreate(open);
  watcher.onDidChange(open);
}

exports.activate = async (context) => {
  context.subscriptions.push(
    commands.registerCommand("rtscript.render", () => run("render", settings().get("renderArguments", []))),
    commands.registerCommand("rtscript.watch", () => run("watch", [])),
    commands.registerCommand("rtscript.restart", restart),
    workspace.onDidChangeConfiguration((change) => change.affectsConfiguration("rtscript.path") && restart()),
  );
  await start();
};

exports.deactivate = () => client?.stop();
