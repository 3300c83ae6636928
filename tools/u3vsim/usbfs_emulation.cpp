#include "usbfs_emulation.hpp"

#include <sys/ioctl.h>
// After it, since it uses _IOR without including what defines it.
#include <linux/usbdevice_fs.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <thread>

#include "usb_descriptors.hpp"

namespace binpick::sim {
namespace {

// One request for any size: libusb then does not split the transfers.
constexpr std::uint32_t kCapabilities = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM |
                                        USBDEVFS_CAP_BULK_SCATTER_GATHER |
                                        USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
// An emulated node always polls ready, so libusb would ask without pause; but a client's calls wait
// for each other, so the pause has to be short.
constexpr std::chrono::microseconds kReapPause{300};
// While a stream waits for its next frame, which ends the pause: each empty answer costs the client
// a round trip.
constexpr std::chrono::microseconds kStreamPause{1000};

usbdevfs_urb* urb_of(UMockdevIoctlData* data) {
  return reinterpret_cast<usbdevfs_urb*>(data->data);
}

void complete(UMockdevIoctlClient* client, long result, int error) {
  umockdev_ioctl_client_complete(client, result, error);
}

// The unsigned that the argument points to; a number that no interface has when there is none.
unsigned number_at(UMockdevIoctlData* argument) {
  unsigned number = ~0u;
  if (UMockdevIoctlData* data = umockdev_ioctl_data_resolve(argument, 0, sizeof number, nullptr)) {
    std::memcpy(&number, data->data, sizeof number);
    g_object_unref(data);
  }
  return number;
}

unsigned interface_of(unsigned endpoint) {
  return endpoint == kStreamIn ? 1 : 0;
}

constexpr std::uint8_t kGetDescriptor = 6;
constexpr std::uint8_t kStringDescriptor = 3;
constexpr std::size_t kSetup = 8;  // bytes before the data of a control transfer

}  // namespace

UsbfsEmulation::UsbfsEmulation(U3vDevice& device, FaultBoard& faults, const SensorName& name)
    : device_(device), faults_(faults), name_(name), handler_(umockdev_ioctl_base_new()) {
  g_signal_connect(handler_, "handle-ioctl", G_CALLBACK(on_ioctl), this);
  g_signal_connect(handler_, "client-connected", G_CALLBACK(on_connected), this);
}

UsbfsEmulation::~UsbfsEmulation() {
  g_signal_handlers_disconnect_by_data(handler_, this);
  for (UMockdevIoctlClient* client : clients_) g_object_weak_unref(G_OBJECT(client), on_gone, this);
  drop(nullptr);
  g_object_unref(handler_);
}

gboolean UsbfsEmulation::on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* self) {
  return static_cast<UsbfsEmulation*>(self)->handle(client) ? TRUE : FALSE;
}

// There is a signal for a client that leaves too, which umockdev never gives: it frees the object.
void UsbfsEmulation::on_connected(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* self) {
  auto& usbfs = *static_cast<UsbfsEmulation*>(self);
  usbfs.clients_.insert(client);
  usbfs.client_count_ = static_cast<int>(usbfs.clients_.size());
  g_object_weak_ref(G_OBJECT(client), on_gone, self);
}

void UsbfsEmulation::on_gone(void* self, GObject* where_it_was) {
  auto& usbfs = *static_cast<UsbfsEmulation*>(self);
  auto* client = reinterpret_cast<UMockdevIoctlClient*>(where_it_was);
  usbfs.drop(client);
  usbfs.clients_.erase(client);
  usbfs.client_count_ = static_cast<int>(usbfs.clients_.size());
}

void UsbfsEmulation::drop(UMockdevIoctlClient* client) {
  std::erase_if(urbs_, [client](const Urb& urb) {
    if (client != nullptr && urb.client != client) return false;
    if (urb.buffer != nullptr) g_object_unref(urb.buffer);
    g_object_unref(urb.data);
    return true;
  });
  std::erase_if(
      claims_, [client](const auto& claim) { return client == nullptr || claim.second == client; });
}

void UsbfsEmulation::claim(UMockdevIoctlClient* client, unsigned interface) {
  const auto holder = claims_.try_emplace(interface, client).first->second;
  if (holder == client) return complete(client, 0, 0);
  complete(client, -1, EBUSY);
}

// As the kernel does it: usbfs, which has no say in a reset, is unbound from every interface, so
// that claims are gone and what programs had under way ends as if the device had left.
void UsbfsEmulation::reset() {
  ++resets_;
  faults_.set("hung", "0");
  device_.power_cycle();
  claims_.clear();
  for (Urb& urb : urbs_) {
    if (!urb.done && urb_of(urb.data)->type != USBDEVFS_URB_TYPE_CONTROL)
      finish(urb, -ESHUTDOWN, 0);
  }
}

bool UsbfsEmulation::handle(UMockdevIoctlClient* client) {
  const unsigned long request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  // Who held the device that was pulled out does not hold the one that came.
  if (arrived_.exchange(false)) claims_.clear();
  if (!plugged_ && request != USBDEVFS_REAPURBNDELAY && request != USBDEVFS_REAPURB) {
    complete(client, -1, ENODEV);
    return true;
  }
  switch (request) {
    case USBDEVFS_GET_CAPABILITIES: {
      UMockdevIoctlData* data =
          umockdev_ioctl_data_resolve(argument, 0, sizeof(std::uint32_t), nullptr);
      if (data == nullptr) return false;
      std::memcpy(data->data, &kCapabilities, sizeof kCapabilities);
      complete(client, 0, 0);
      g_object_unref(data);
      return true;
    }
    case USBDEVFS_CLEAR_HALT:
    case USBDEVFS_RESETEP:
      device_.clear_halt();
      faults_.set("stall", "0");
      complete(client, 0, 0);
      return true;
    case USBDEVFS_RESET:
      reset();
      complete(client, 0, 0);
      return true;
    // Both begin with the interface's number.
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
      claim(client, number_at(argument));
      return true;
    case USBDEVFS_RELEASEINTERFACE:
      std::erase_if(claims_, [client, number = number_at(argument)](const auto& claim) {
        return claim.first == number && claim.second == client;
      });
      complete(client, 0, 0);
      return true;
    case USBDEVFS_SETCONFIGURATION:
    case USBDEVFS_SETINTERFACE:
      complete(client, 0, 0);
      return true;
    case USBDEVFS_GETDRIVER:
    case USBDEVFS_IOCTL:
      complete(client, -1, ENODATA);  // no kernel driver has the interfaces
      return true;
    case USBDEVFS_SUBMITURB:
      return submit(client,
                    umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr));
    case USBDEVFS_DISCARDURB:
      return discard(client, argument);
    case USBDEVFS_REAPURB:
    case USBDEVFS_REAPURBNDELAY:
      return reap(client, argument);
    default:
      complete(client, -1, ENOTTY);
      return true;
  }
}

bool UsbfsEmulation::submit(UMockdevIoctlClient* client, UMockdevIoctlData* urb_data) {
  if (urb_data == nullptr) return false;
  const usbdevfs_urb* request = urb_of(urb_data);
  // Who uses an interface without a claim is given it where nobody else has it.
  if (request->type != USBDEVFS_URB_TYPE_CONTROL &&
      claims_.try_emplace(interface_of(request->endpoint), client).first->second != client) {
    g_object_unref(urb_data);
    complete(client, -1, EBUSY);
    return true;
  }
  Urb urb{client, urb_data, nullptr, false};
  if (request->buffer_length > 0) {
    urb.buffer = umockdev_ioctl_data_resolve(urb_data, offsetof(usbdevfs_urb, buffer),
                                             static_cast<gsize>(request->buffer_length), nullptr);
  }
  urbs_.push_back(urb);
  complete(client, 0, 0);
  return true;
}

bool UsbfsEmulation::discard(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  unsigned long address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  for (Urb& urb : urbs_) {
    if (urb.client != client || urb.data->client_addr != address || urb.done) continue;
    finish(urb, -ENOENT, 0);
    complete(client, 0, 0);
    return true;
  }
  complete(client, -1, EINVAL);
  return true;
}

void UsbfsEmulation::finish(Urb& urb, int status, std::size_t bytes) {
  urb_of(urb.data)->status = status;
  urb_of(urb.data)->actual_length = static_cast<int>(bytes);
  urb.done = true;
}

void UsbfsEmulation::control_transfer(Urb& urb) {
  if (urb.buffer == nullptr || urb.buffer->data_len < static_cast<int>(kSetup))
    return finish(urb, -EPIPE, 0);
  std::uint8_t* setup = urb.buffer->data;
  const bool is_in = (setup[0] & 0x80) != 0;
  if (!is_in) return finish(urb, 0, 0);  // a halt of an endpoint is set: what follows clears it
  if (setup[1] != kGetDescriptor || setup[3] != kStringDescriptor) return finish(urb, -EPIPE, 0);
  const std::vector<std::uint8_t> text = string_descriptor(setup[2], name_);
  if (text.empty()) return finish(urb, -EPIPE, 0);
  const std::size_t room = static_cast<std::size_t>(urb.buffer->data_len) - kSetup;
  const std::size_t bytes = std::min(room, text.size());
  std::memcpy(setup + kSetup, text.data(), bytes);
  finish(urb, 0, bytes);
}

// Does what can be done of what was submitted, in its order.
void UsbfsEmulation::advance() {
  bool stream_waits = false;
  for (Urb& urb : urbs_) {
    if (urb.done) continue;
    const usbdevfs_urb* request = urb_of(urb.data);
    if (request->type == USBDEVFS_URB_TYPE_CONTROL) {
      control_transfer(urb);
      continue;
    }
    const auto size = static_cast<std::size_t>(urb.buffer == nullptr ? 0 : urb.buffer->data_len);
    const std::span<std::uint8_t> buffer(urb.buffer == nullptr ? nullptr : urb.buffer->data, size);
    if (request->endpoint == kControlOut) {
      device_.command(buffer);
      finish(urb, 0, size);
    } else if (request->endpoint == kControlIn) {
      const std::vector<std::uint8_t> answer = device_.take_acknowledgement();
      if (answer.empty()) continue;
      const std::size_t bytes = std::min(size, answer.size());
      std::copy_n(answer.begin(), bytes, buffer.begin());
      finish(urb, 0, bytes);
    } else if (request->endpoint == kStreamIn && !stream_waits) {
      if (faults_.on(kStall)) {
        finish(urb, -EPIPE, 0);
        continue;
      }
      const std::ptrdiff_t bytes = device_.take_stream(buffer);
      stream_waits = bytes < 0;
      if (bytes >= 0) finish(urb, 0, static_cast<std::size_t>(bytes));
    }
  }
}

bool UsbfsEmulation::reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  if (!plugged_) {
    for (Urb& urb : urbs_) {
      if (!urb.done) finish(urb, -ESHUTDOWN, 0);
    }
  } else if (answers()) {
    advance();
  }
  const auto is_ready = [client](const Urb& urb) { return urb.done && urb.client == client; };
  auto done = std::find_if(urbs_.begin(), urbs_.end(), is_ready);
  if (done == urbs_.end() && plugged_) {
    const bool stream_waits = std::any_of(urbs_.begin(), urbs_.end(), [](const Urb& urb) {
      return urb_of(urb.data)->endpoint == kStreamIn;
    });
    if (stream_waits) {
      device_.wait_for_data(kStreamPause);
    } else {
      std::this_thread::sleep_for(kReapPause);
    }
    if (answers()) advance();
    done = std::find_if(urbs_.begin(), urbs_.end(), is_ready);
  }
  if (done == urbs_.end()) {
    complete(client, -1, plugged_ ? EAGAIN : ENODEV);
    return true;
  }
  UMockdevIoctlData* target = umockdev_ioctl_data_resolve(argument, 0, sizeof(void*), nullptr);
  if (target == nullptr) return false;
  umockdev_ioctl_data_set_ptr(target, 0, done->data);
  complete(client, 0, 0);
  g_object_unref(target);
  if (done->buffer != nullptr) g_object_unref(done->buffer);
  g_object_unref(done->data);
  urbs_.erase(done);
  return true;
}

}  // namespace binpick::sim
