// underbody study set: changes a value in study.toml.
#pragma once

namespace CLI {
class App;
}

namespace underbody::studio {

class Shell;
void add_study_set(CLI::App& study, Shell& shell);

}  // namespace underbody::studio
