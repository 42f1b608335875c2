// Commands of the command line, run in this process.
#include <pybind11/stl.h>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "studio/cli/caller.h"
#include "studio/cli/option_tree.h"
#include "studio/cli/program.h"
#include "studio/cli/shell.h"
#include "studio/python/call.h"
#include "studio/python/module.h"

namespace underbody::python {

namespace {

struct Run {
    int code = 0;
    studio::Caller caller;
};

/// `words`: the command line without the program's name; `fields` and `fitted`: what stands for paths among them.
py::tuple run(const std::vector<std::string>& words, const std::map<std::string, postproc::Field>& fields,
              const std::map<std::string, tables::ForceTable>& fitted, const std::string& program,
              const py::object& progress) {
    Run result;
    result.caller.fields = fields;
    for (const auto& [path, table] : fitted) {
        result.caller.fitted[path] = {table};
    }
    result.caller.program = program;
    Call call(progress);
    studio::Shell shell(result.caller, call.listener());
    call.run(shell.progress(), [&] {
        CLI::App app;
        studio::add_commands(app, shell, words.empty() ? std::string() : words.front());
        std::vector<const char*> arguments = {"underbody"};
        for (const auto& word : words) {
            arguments.push_back(word.c_str());
        }
        result.code = shell.execute(app, static_cast<int>(arguments.size()), arguments.data());
    });
    py::list remarks;
    for (const auto& [level, text] : result.caller.remarks) {
        remarks.append(py::make_tuple(static_cast<int>(level), text));
    }
    py::dict tables;
    for (auto& [name, table] : result.caller.tables) {
        tables[name.c_str()] = columns_of(std::move(table));
    }
    const py::object surface =
        result.caller.surface ? py::cast(std::move(*result.caller.surface)) : py::object(py::none());
    return py::make_tuple(result.code, result.caller.document, remarks, tables, surface, result.caller.error_class,
                          result.caller.error);
}

std::string tree() {
    studio::Caller nobody;
    studio::Shell shell(nobody, {});
    CLI::App app;
    studio::add_commands(app, shell);
    return studio::option_tree(app).dump();
}

}  // namespace

void add_commands(py::module_& module) {
    module.def("run", &run);
    module.def("tree", &tree);
}

}  // namespace underbody::python
