// The sub-commands of `underbody table` that look at several equilibria, pitches, variants or speeds at once.
#pragma once

namespace CLI {
class App;
}

namespace underbody::studio {

class Shell;

/// continue | pitch | compare | collapse
void add_table_analysis(CLI::App& table, Shell& shell);

}  // namespace underbody::studio
