// The kernel's usbfs, as a program sees it through libusb, for one device under umockdev: takes in
// what is submitted, and lets it be reaped when the device has done it.
// Thread: umockdev's; plug and unplug may come from another.
#pragma once

#include <umockdev.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <vector>

#include "u3v_device.hpp"

namespace binpick::sim {

class UsbfsEmulation {
 public:
  UsbfsEmulation(U3vDevice& device, FaultBoard& faults, const SensorName& name);
  ~UsbfsEmulation();
  UsbfsEmulation(const UsbfsEmulation&) = delete;
  UsbfsEmulation& operator=(const UsbfsEmulation&) = delete;

  UMockdevIoctlBase* handler() { return handler_; }
  // Without it every call fails as the kernel's do for a device that was pulled out.
  void set_plugged(bool plugged) {
    if (plugged) arrived_ = true;
    plugged_ = plugged;
  }
  // How often programs have the device open.
  int clients() const { return client_count_; }
  // Of the port, by hosts.
  std::uint64_t resets() const { return resets_; }

 private:
  // A request that was submitted and not yet reaped.
  struct Urb {
    UMockdevIoctlClient* client;  // whose open node it came through; not owned
    UMockdevIoctlData* data;      // the usbdevfs_urb; owned
    UMockdevIoctlData* buffer;    // owned; nullptr when it has none
    bool done;
  };
  static gboolean on_ioctl(UMockdevIoctlBase* base, UMockdevIoctlClient* client, void* self);
  static void on_connected(UMockdevIoctlBase* base, UMockdevIoctlClient* client, void* self);
  static void on_gone(void* self, GObject* where_it_was);
  bool handle(UMockdevIoctlClient* client);
  bool submit(UMockdevIoctlClient* client, UMockdevIoctlData* urb_data);
  bool discard(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  bool reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  void finish(Urb& urb, int status, std::size_t bytes);
  void control_transfer(Urb& urb);
  bool answers() const { return !faults_.on(kFrozen) && !faults_.on(kHung); }
  void advance();
  // What a client has under way and holds; nullptr: of all clients.
  void drop(UMockdevIoctlClient* client);
  void claim(UMockdevIoctlClient* client, unsigned interface);
  void reset();

  U3vDevice& device_;
  FaultBoard& faults_;
  const SensorName name_;
  UMockdevIoctlBase* handler_;
  std::atomic<bool> plugged_{true};
  std::atomic<bool> arrived_{false};  // and nobody has asked it anything since
  std::deque<Urb> urbs_;
  std::map<unsigned, UMockdevIoctlClient*> claims_;  // by interface
  std::set<UMockdevIoctlClient*> clients_;
  std::atomic<int> client_count_{0};  // of them, for other threads
  std::atomic<std::uint64_t> resets_{0};
};

}  // namespace binpick::sim
