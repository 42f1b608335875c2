// The Python module underbody._underbody: what the package underbody is made of.
#include "studio/python/module.h"

#include <pybind11/stl.h>

#include <filesystem>

#include "core/error.h"
#include "core/units.h"
#include "studio/python/call.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::python {

namespace {

/// The same classes as the command line's exit codes tell apart.
void translate(std::exception_ptr thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const core::Cancelled& error) {
        raise("Cancelled", error);
    } catch (const core::UsageError& error) {
        raise("UsageError", error);
    } catch (const core::InputError& error) {
        const bool argument = error.place().file.empty() && (error.kind() == "unit" || error.kind() == "parse");
        raise(argument ? "UsageError" : "InputError", error);  // as Shell::run_action has it
    } catch (const core::Error& error) {
        raise("SystemError", error);
    } catch (const std::filesystem::filesystem_error& error) {
        raise("SystemError", core::SystemError("file", error.code().message(), {error.path1().string(), {}, {}, {}}));
    }
}

}  // namespace

}  // namespace underbody::python

PYBIND11_MODULE(_underbody, module) {
    namespace py = pybind11;
    using namespace underbody;
    py::register_local_exception_translator(python::translate);
    module.attr("version") = UNDERBODY_VERSION;
    module.def("parse_in", [](const std::string& text, const std::string& unit) { return core::parse_in(text, unit); });
    module.def("did_you_mean", &core::did_you_mean);
    module.def("read_model", [](const std::string& path) {
        const dynamics::Model model = dynamics::read_model(path);
        std::vector<std::string> jets, effects;
        for (const auto& jet : model.jets) {
            jets.push_back(jet.name);
        }
        for (const auto& effect : model.effects) {
            effects.push_back(effect.name);
        }
        return py::make_tuple(model.quantities(), jets, effects);
    });
    python::add_fields(module);
    python::add_tables(module);
    python::add_commands(module);
}
