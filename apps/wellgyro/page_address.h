#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace wellgyro::apps {

/// Where a live page is served.
struct PageAddress {
  std::string host = "127.0.0.1";
  int port = 0;          ///< 0: any that is free
  bool loopback = true;  ///< reached from this machine only
};

/// Of "127.0.0.1:8080", "[::1]:8080", "rig-pc:8080" or "8080".
std::optional<PageAddress> PageAddressOf(std::string_view text);

/// Whether a request may name this host ("Host:" of HTTP). A page of a stranger that has its own
/// name point to this machine (DNS rebinding) asks under that name: where the page is for this
/// machine alone, only names of the loopback are let in; elsewhere also addresses in digits and
/// `own_name`, the machine's.
bool MayName(std::string_view host_header, const PageAddress& address, std::string_view own_name);

/// 128 bits of the system's randomness, in hexadecimal.
std::string NewToken();
/// Whether both are the same, in a time that does not tell where they differ.
bool SameToken(const std::string& given, const std::string& token);
/// The token in the file `path`; a new one is made there, readable by its owner alone, where there
/// is none. Empty where it cannot be read or written, or is shorter than 16 characters.
std::string TokenIn(const std::string& path);

}  // namespace wellgyro::apps
