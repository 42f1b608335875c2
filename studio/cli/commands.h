// The commands, one file each; a new command is one file and one line here.
#pragma once

namespace CLI {
class App;
}

namespace underbody::studio {

class Shell;

#define UNDERBODY_COMMANDS(X) \
    X(body)                   \
    X(info)                   \
    X(import)                 \
    X(loads)                  \
    X(views)                  \
    X(probe)                  \
    X(discover)               \
    X(simulate)               \
    X(predict)                \
    X(region)                 \
    X(table)                  \
    X(export)                 \
    X(study)                  \
    X(solve)                  \
    X(sweep)                  \
    X(design)                 \
    X(learn)                  \
    X(estimate)               \
    X(control)                \
    X(linear)                 \
    X(new)                    \
    X(list)                   \
    X(theory)                 \
    X(doctor)                 \
    X(completion)             \
    X(watch)

#define UNDERBODY_DECLARE(name) void add_##name##_command(CLI::App& app, Shell& shell);
UNDERBODY_COMMANDS(UNDERBODY_DECLARE)
#undef UNDERBODY_DECLARE

}  // namespace underbody::studio
