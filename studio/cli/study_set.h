// underbody study set: changes a value in study.toml. underbody study accept: a found model becomes the study's own.
#pragma once

namespace CLI {
class App;
}

namespace underbody::studio {

class Shell;
void add_study_set(CLI::App& study, Shell& shell);
void add_study_accept(CLI::App& study, Shell& shell);

}  // namespace underbody::studio
