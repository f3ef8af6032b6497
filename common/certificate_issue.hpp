// Makes authorities and what they sign, as farhand-keygen does.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "common/certificates.hpp"

namespace farhand {

// Days from now.
struct Lifetime {
  int from = -1;  // the other side's clock may be late
  int until = 825;
};

struct Issued {
  std::shared_ptr<x509_st> certificate;
  std::shared_ptr<evp_pkey_st> private_key;
};

struct Request {
  std::string name;   // its common name
  std::string usage;  // extended, as OpenSSL writes them: "clientAuth"; empty: not named
  Lifetime lifetime;
};

// Signs itself and may sign others, but not authorities.
Issued make_authority(const std::string& name, const Lifetime& lifetime = {});
// A new key and a certificate for it.
Issued issue(const Issued& by, const Request& request);

// Of a master or a slave.
const char* usage_of(DtlsRole role) noexcept;
std::string observer_usage();

std::string to_pem(x509_st& certificate);
std::string to_pem(evp_pkey_st& private_key);

// In `directory`, made if it is not there: a master's, a slave's and an observer's certificate and
// private key, NAME.pem and NAME_key.pem, the keys only their owner may read; and authority.pem, a
// new authority's, whose private key is written nowhere: it signs nothing more. The authority's
// fingerprint. Throws a sentence, and leaves no file made, if one exists or cannot be written.
std::string write_new_certificates(const std::filesystem::path& directory, int days);

}  // namespace farhand
