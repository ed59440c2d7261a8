// The diagnosis on trial: each mistake of an adapter is told in its words, and no right engine is
// told anything.
#include "experiments/conformance/diagnosis.hpp"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "adapters/catalog.hpp"
#include "tests/faults/seeded_faults.hpp"

namespace brickbench::testing {
namespace {

using conformance::diagnose;
using conformance::Subject;
using conformance::Symptoms;

// Of every fault in what an adapter translates, sets, pushes or reads. What goes wrong inside steps
// is no adapter's, and is for hunt and oracle.
const std::map<std::string, std::string>& words_of_faults() {
  static const std::map<std::string, std::string> words = {
      {"gravity_1_percent", "gravity looks 1.01 times what it should be"},
      {"gravity_missing", "gravity does not act"},
      {"gravity_sideways", "only the vertical part of gravity acts"},
      {"friction_ignored", "friction does not act"},
      {"friction_squared", "friction looks squared"},
      {"restitution_ignored", "restitution does not act"},
      {"restitution_squared", "restitution looks squared"},
      {"laws_swapped", "friction and restitution look exchanged"},
      {"exceptions_forgotten", "the law of a single pair looks forgotten"},
      {"mass_1_percent", "mass looks 1.01 times what it should be"},
      {"inertia_of_a_sphere", "inertia looks like that of a ball"},
      {"inertia_axes_rotated", "moments of inertia look in the order y, z, x"},
      {"size_1_permille", "shapes look 1.001 times as large"},
      {"velocity_lost", "velocities are lost"},
      {"spin_turned", "angular velocities look turned by 0.3 rad about (1, "},
      {"attitude_inverted", "orientations look inverted"},
      {"step_halved", "step is not exactly step_s: bodies go 0.5 of the way"},
      {"step_rounded", "step is not exactly step_s: bodies go 1.000001 of the way"},
      {"setting_swallowed", "does not arrive"},
      {"knob_swallowed", "does not arrive"},
      {"variant_swallowed", "move to the same bits: is it one of them?"},
      {"wrench_ignored", "applied forces do not act"},
      {"wrench_late", "forces applied in the first step are lost"},
      {"torque_sign", "torques act with the wrong sign"},
      {"momentum_leak", "velocities change by -1e-06 of themselves in each step"},
      {"spin_read_in_body_frame", "angular velocities look body-framed"},
      {"quaternion_order", "quaternion order looks x, y, z, w"},
      {"attitude_read_inverted", "orientations look inverted"},
      {"bodies_swapped", "bodies 1 and 2 show each other's states"},
      {"state_one_step_old", "states look one step old"},
      {"velocity_from_positions", "velocities look 0.5 times what they should be"},
      {"single_precision", "positions look rounded to single precision"},
      {"not_a_number", "not finite"},
      {"impulse_sign", "contact impulses look as if on body a"},
      {"impulse_as_force", "contact impulses look like forces"},
      {"contact_dropped", "contacts look incomplete"},
      {"friction_not_reported", "friction is missing from the impulses"},
      {"contact_point_shifted", "contact points lie up to 0.01 m outside"},
      {"contacts_doubled", "contacts look told twice"},
  };
  return words;
}

std::string joined(const Symptoms& symptoms) {
  std::string text;
  for (const std::string& words : symptoms) text += words + "; ";
  return text;
}

// In the words meant for it, with and without an audit to read back.
TEST(Diagnosis, EachSeededFaultOfAnAdapterIsToldInItsWords) {
  if (correct_adapter().name.empty()) GTEST_SKIP() << "no engine can be spoilt";
  std::size_t told = 0;
  for (std::size_t i = 0; i < seeded_faults().size(); ++i) {
    const auto wanted = words_of_faults().find(seeded_faults()[i].name);
    if (wanted == words_of_faults().end()) {
      EXPECT_TRUE(i == 0 || seeded_faults()[i].step != nullptr)
          << seeded_faults()[i].name << " is a fault of an adapter without words";
      continue;
    }
    const Adapter adapter = faulty_adapter(i, true);
    const std::string symptoms = joined(diagnose({adapter, adapter.variants.front().name}));
    EXPECT_NE(symptoms.find(wanted->second), std::string::npos)
        << seeded_faults()[i].name << ": " << symptoms;
    ++told;
  }
  EXPECT_EQ(told, words_of_faults().size());
}

TEST(Diagnosis, OfARightEngineThereIsNothingToTell) {
  for (const Adapter& adapter : adapters()) {
    for (const Variant& variant : adapter.variants) {
      EXPECT_EQ(joined(diagnose({adapter, variant.name})), "")
          << adapter.name << "/" << variant.name;
    }
  }
}

}  // namespace
}  // namespace brickbench::testing
