#include "modbus/server_counters.hpp"

namespace binpick::modbus {
namespace {

constexpr std::array<const char*, kCountNumber> kNames = {
    "accepted",         "refused_address", "refused_limit",        "replaced_by_writer",
    "closed_by_client", "closed_idle",     "closed_partial_frame", "closed_unread",
    "wrong_protocol",   "wrong_length",    "read_holding",         "read_input",
    "write_one",        "write_many",      "read_write_many",      "illegal_function",
    "illegal_address",  "illegal_value",   "server_failure",       "target_silent",
    "commands",         "accept_paused",
};

}  // namespace

const char* count_name(Count count) {
  return kNames[static_cast<std::size_t>(count)];
}

}  // namespace binpick::modbus
