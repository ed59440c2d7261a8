#include "cli/verbs_json.hpp"

namespace brickbench {
namespace {

using Json = nlohmann::ordered_json;

Json option_json(const CLI::Option& option) {
  const bool placed = option.get_lnames().empty();
  const bool is_switch = option.get_type_size() == 0;
  return {{"id", placed ? option.get_name(true) : "--" + option.get_lnames().front()},
          {"value", is_switch ? "" : option.get_type_name()},
          {"required", option.get_required()},
          {"meaning", option.get_description()}};
}

void add_verbs(const CLI::App& above, const std::string& prefix, Json& array) {
  for (const CLI::App* verb : above.get_subcommands([](const CLI::App*) { return true; })) {
    auto options = Json::array();
    for (const CLI::Option* option : verb->get_options()) {
      if (option != verb->get_help_ptr()) options.push_back(option_json(*option));
    }
    const std::string id = prefix + verb->get_name();
    array.push_back({{"id", id}, {"meaning", verb->get_description()}, {"options", options}});
    add_verbs(*verb, id + ' ', array);
  }
}

}  // namespace

Json verbs_json(const CLI::App& app) {
  auto array = Json::array();
  add_verbs(app, "", array);
  return array;
}

}  // namespace brickbench
