// brickbench_engine.hpp: an engine for brickbench in C++20, with nothing but this header.
//
// Derive from brickbench_engine::Engine, hand an object to brickbench_engine::serve(): that is a
// program that speaks the protocol (docs/protocol.md). SI units, z up, quaternions w, x, y, z from
// body to world, velocities of the centre of mass in the world frame. The system must be little
// endian and have POSIX descriptors.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace brickbench_engine {

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;  // w, x, y, z

struct BodyState {
  Vector position_m{};
  Quaternion orientation{1, 0, 0, 0};
  Vector velocity_mps{};
  Vector angular_velocity_radps{};
};

struct Law {
  double friction = 0.0;
  double restitution = 0.0;
};

struct Form {
  std::string kind;         // box, sphere or plane (solid below z = 0 of its frame)
  Vector half_extents_m{};  // of a box
  double radius_m = 0.0;    // of a sphere
};

struct Thing {
  std::string name;
  Form form;
  bool fixed = false;
  double mass_kg = 0.0;
  Vector inertia_kgm2{};  // principal, body axes
  int surface = 0;
  BodyState initial;
};

struct SurfacePair {
  int surface_a = 0;
  int surface_b = 0;
  Law law;
};

struct Scenery {
  Vector gravity_mps2{};
  Law law;                              // of every pair of surfaces that is no exception
  std::vector<SurfacePair> exceptions;  // unordered pairs
  std::vector<Thing> bodies;

  Law law_of(std::size_t a, std::size_t b) const {
    const int i = bodies[a].surface, k = bodies[b].surface;
    for (const SurfacePair& pair : exceptions) {
      const bool same = pair.surface_a == i && pair.surface_b == k;
      if (same || (pair.surface_a == k && pair.surface_b == i)) return pair.law;
    }
    return law;
  }
};

struct Setup {
  double step_s = 0.0;
  std::string variant;
  std::map<std::string, double> knobs;  // of the variant, each with its value
  int threads = 1;
};

struct Push {
  Vector force_n{};
  Vector torque_nm{};
};

struct Touch {
  std::uint64_t body_a = 0, body_b = 0;  // order of Scenery::bodies
  Vector position_m{};
  Vector normal{};  // unit, from a towards b
  double gap_m = 0.0;
  Vector impulse_ns{};  // on b, during the last step
};

// What the engine cannot do; the fault is a word of the protocol.
struct Refusal : std::runtime_error {
  explicit Refusal(const std::string& reason, std::string word = "refused")
      : std::runtime_error(reason), fault(std::move(word)) {}
  std::string fault;
};

class Engine {
 public:
  virtual ~Engine() = default;
  // The answer to `hello` without "protocol": see docs/protocol.md.
  virtual std::string hello() const = 0;
  // Of contacts, set_state, audit, diagnostics: what is offered below.
  virtual std::vector<std::string> views() const { return {}; }
  // Throws Refusal where it cannot achieve these facts.
  virtual void build(const Scenery& scenery, const Setup& setup) = 0;
  // By exactly step_s; a push for each body, or none at all.
  virtual void step(std::span<const Push> pushes) = 0;
  virtual std::vector<BodyState> states() const = 0;

  virtual void set_state(std::span<const BodyState>) { throw Refusal("no set_state", "invalid"); }
  virtual std::vector<Touch> contacts() const { throw Refusal("no contacts", "invalid"); }
  virtual std::string audit() const { throw Refusal("no audit", "invalid"); }
  virtual Law pair_law(std::size_t, std::size_t) const { throw Refusal("no audit", "invalid"); }
};

// ---- JSON, as much as the protocol needs ----

struct Value {
  enum class Kind { null, boolean, number, text, array, object } kind = Kind::null;
  double number = 0.0;
  std::string text;
  std::vector<Value> items;
  std::map<std::string, Value> fields;

  const Value& at(const std::string& name) const {
    const auto found = fields.find(name);
    if (found == fields.end()) throw Refusal("'" + name + "' is missing", "invalid");
    return found->second;
  }
};

class Parser {
 public:
  explicit Parser(std::string_view text) : rest_(text) {}
  Value value() {
    Value value;
    const char first = peek();
    if (first == '{') {
      value.kind = Value::Kind::object;
      list('{', '}', [&] {
        const std::string name = quoted();
        expect(':');
        value.fields[name] = this->value();
      });
    } else if (first == '[') {
      value.kind = Value::Kind::array;
      list('[', ']', [&] { value.items.push_back(this->value()); });
    } else if (first == '"') {
      value.kind = Value::Kind::text;
      value.text = quoted();
    } else if (word("true") || word("false")) {
      value.kind = Value::Kind::boolean;
      value.number = first == 't' ? 1.0 : 0.0;
    } else if (!word("null")) {
      value.kind = Value::Kind::number;
      const auto read = std::from_chars(rest_.data(), rest_.data() + rest_.size(), value.number);
      if (read.ec != std::errc()) wrong();
      rest_.remove_prefix(static_cast<std::size_t>(read.ptr - rest_.data()));
    }
    return value;
  }

 private:
  [[noreturn]] static void wrong() { throw Refusal("no JSON", "invalid"); }
  char peek() {
    while (!rest_.empty() &&
           std::string_view(" \n\r\t").find(rest_.front()) != std::string_view::npos)
      skip();
    if (rest_.empty()) wrong();
    return rest_.front();
  }
  void skip(std::size_t count = 1) { rest_.remove_prefix(count); }
  void expect(char c) {
    if (peek() != c) wrong();
    skip();
  }
  bool word(std::string_view text) {
    if (!rest_.starts_with(text)) return false;
    skip(text.size());
    return true;
  }
  template <typename Item>
  void list(char open, char close, const Item& item) {
    expect(open);
    if (peek() == close) return skip();
    while (true) {
      item();
      const char next = peek();
      skip();
      if (next == close) return;
      if (next != ',') wrong();
    }
  }
  std::string quoted() {
    expect('"');
    std::string text;
    while (!rest_.empty() && rest_.front() != '"') {
      if (rest_.front() == '\\' && rest_.size() > 1) skip();  // names alone hold escapes
      text += rest_.front();
      skip();
    }
    if (rest_.empty()) wrong();
    skip();
    return text;
  }
  std::string_view rest_;
};

inline std::string quoted(std::string_view text) {
  std::string json = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') json += '\\';
    json += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return json + '"';
}

// The shortest text that reads back to the same number.
inline std::string number_text(double number) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

inline std::string vector_text(const Vector& v) {
  return std::string("[") + number_text(v[0]) + "," + number_text(v[1]) + "," + number_text(v[2]) +
         "]";
}

inline std::string form_text(const Form& form) {
  std::string json = std::string("{\"kind\":") + quoted(form.kind);
  if (form.kind == "box")
    json.append(",\"half_extents_m\":").append(vector_text(form.half_extents_m));
  if (form.kind == "sphere") json.append(",\"radius_m\":").append(number_text(form.radius_m));
  return json + "}";
}

// ---- from JSON ----

inline Vector to_vector(const Value& value) {
  if (value.items.size() != 3) throw Refusal("three numbers are wanted", "invalid");
  return {value.items[0].number, value.items[1].number, value.items[2].number};
}

inline Law to_law(const Value& value) {
  return {value.at("friction").number, value.at("restitution").number};
}

inline Thing to_thing(const Value& value) {
  Thing thing;
  thing.name = value.at("name").text;
  const Value& shape = value.at("shape");
  thing.form.kind = shape.at("kind").text;
  if (thing.form.kind == "box") thing.form.half_extents_m = to_vector(shape.at("half_extents_m"));
  if (thing.form.kind == "sphere") thing.form.radius_m = shape.at("radius_m").number;
  thing.fixed = value.at("fixed").number != 0.0;
  thing.mass_kg = value.at("mass_kg").number;
  thing.inertia_kgm2 = to_vector(value.at("inertia_kgm2"));
  thing.surface = static_cast<int>(value.at("surface").number);
  const Value& initial = value.at("initial");
  thing.initial.position_m = to_vector(initial.at("position_m"));
  const Value& q = initial.at("orientation");
  for (std::size_t i = 0; i < 4; ++i) thing.initial.orientation[i] = q.items.at(i).number;
  thing.initial.velocity_mps = to_vector(initial.at("velocity_mps"));
  thing.initial.angular_velocity_radps = to_vector(initial.at("angular_velocity_radps"));
  return thing;
}

inline Scenery to_scenery(const Value& value) {
  Scenery scenery;
  scenery.gravity_mps2 = to_vector(value.at("gravity_mps2"));
  scenery.law = to_law(value.at("law"));
  for (const Value& pair : value.at("exceptions").items) {
    scenery.exceptions.push_back({static_cast<int>(pair.at("surface_a").number),
                                  static_cast<int>(pair.at("surface_b").number),
                                  to_law(pair.at("law"))});
  }
  for (const Value& body : value.at("bodies").items) scenery.bodies.push_back(to_thing(body));
  return scenery;
}

inline Setup to_setup(const Value& value) {
  Setup setup;
  setup.step_s = value.at("step_s").number;
  setup.variant = value.at("variant").text;
  for (const auto& [name, number] : value.at("knobs").fields) setup.knobs[name] = number.number;
  setup.threads = static_cast<int>(value.at("threads").number);
  return setup;
}

// ---- frames ----

static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(BodyState) == 13 * sizeof(double) && sizeof(Push) == 6 * sizeof(double) &&
              sizeof(Touch) == 96);

template <typename Plain>
void put(std::string& bytes, const Plain& plain) {
  std::array<char, sizeof(Plain)> raw;
  std::memcpy(raw.data(), &plain, sizeof(Plain));
  bytes.append(raw.data(), raw.size());
}

template <typename Plain>
std::vector<Plain> take_all(std::string_view bytes) {
  std::vector<Plain> all(bytes.size() / sizeof(Plain));
  if (!all.empty())
    std::memcpy(static_cast<void*>(all.data()), bytes.data(), all.size() * sizeof(Plain));
  return all;
}

inline double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline void put_record(std::string& bytes, const Engine& engine, double took_s) {
  put(bytes, took_s);
  put(bytes, std::array<std::uint64_t, 2>{});  // no flags, no diagnostics
  for (const BodyState& state : engine.states()) put(bytes, state);
}

struct Said {
  std::string word;
  std::string payload;
};

inline Said build_answer(Engine& engine, std::string_view payload) {
  const Value order = Parser(payload).value();
  const double begun_s = cpu_s();
  engine.build(to_scenery(order.at("world")), to_setup(order.at("settings")));
  std::string views;
  for (const std::string& view : engine.views()) {
    if (!views.empty()) views += ',';
    views += quoted(view);
  }
  return {"built", std::string("{\"views\":[") + views +
                       "],\"cpu_s\":" + number_text(cpu_s() - begun_s) + "}"};
}

inline Said step_answer(Engine& engine, std::string_view payload) {
  const auto count = take_all<std::uint64_t>(payload.substr(0, 8)).at(0);
  std::vector<Push> pushes = take_all<Push>(payload.substr(8));
  std::string records;
  for (std::uint64_t k = 0; k < count; ++k) {
    const double begun_s = cpu_s();
    engine.step(pushes);
    put_record(records, engine, cpu_s() - begun_s);
    pushes.clear();  // they act in the first step alone
  }
  return {"states", records};
}

inline Said answer(Engine& engine, const std::string& word, std::string_view payload) {
  std::string bytes;
  if (word == "hello") {
    if (Parser(payload).value().at("protocol").number != 1.0) {
      throw Refusal("this engine speaks protocol 1");
    }
    return {"hello", std::string("{\"protocol\":1,") + engine.hello().substr(1)};
  }
  if (word == "build") return build_answer(engine, payload);
  if (word == "step") return step_answer(engine, payload);
  if (word == "read") {
    put_record(bytes, engine, 0.0);
    return {"states", bytes};
  }
  if (word == "setstate") {
    engine.set_state(take_all<BodyState>(payload));
    return {"done", ""};
  }
  if (word == "contacts") {
    for (const Touch& touch : engine.contacts()) put(bytes, touch);
    return {"contacts", bytes};
  }
  if (word == "audit") return {"audit", engine.audit()};
  if (word == "pairlaw") {
    const auto pair = take_all<std::uint64_t>(payload);
    put(bytes, engine.pair_law(pair.at(0), pair.at(1)));
    return {"pairlaw", bytes};
  }
  throw Refusal("'" + word + "' is no question", "invalid");
}

inline bool read_whole(std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t got = ::read(STDIN_FILENO, bytes.data() + done, bytes.size() - done);
    if (got <= 0) return false;
    done += static_cast<std::size_t>(got);
  }
  return true;
}

inline bool write_whole(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::write(descriptor, bytes.data(), bytes.size());
    if (sent <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  return true;
}

// Answers questions until there are no more; returns the exit status of the program.
inline int serve(Engine& engine) {
  // What anyone prints goes to standard error: only frames belong on standard output.
  const int frames = ::dup(STDOUT_FILENO);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  for (std::string head(16, ' '); read_whole(head);) {
    const std::string word = head.substr(0, std::min<std::size_t>(head.find(' '), 8));
    std::string payload(take_all<std::uint64_t>(std::string_view(head).substr(8)).at(0), ' ');
    if (!read_whole(payload)) return 1;
    Said said;
    try {
      said = answer(engine, word, payload);
    } catch (const Refusal& refusal) {
      said = {"failed", std::string("{\"fault\":") + quoted(refusal.fault) +
                            ",\"reason\":" + quoted(refusal.what()) + "}"};
    }
    said.word.resize(8, ' ');
    put(said.word, std::uint64_t{said.payload.size()});
    if (!write_whole(frames, said.word + said.payload)) return 1;
  }
  return 0;
}

}  // namespace brickbench_engine
