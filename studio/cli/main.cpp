#include <CLI/CLI.hpp>

#include "studio/cli/program.h"
#include "studio/cli/shell.h"

int main(int argc, char** argv) {
    underbody::studio::Shell shell;
    CLI::App app;
    underbody::studio::add_commands(app, shell);
    return shell.run(app, argc, argv);
}
