// The other way for the two sides of a link to prove who they are: each has a certificate of its
// own and the private key to it, and one authority has signed both (X.509, ECDSA over P-256, PEM).
// A master's or observer's certificate says clientAuth as its extended key usage, a slave's
// serverAuth, so that neither can be used as the other. An observer's also says kObserverUsage:
// with it nobody leads.
#pragma once

#include <cstdint>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>

struct evp_pkey_st;
struct x509_st;

namespace farhand {

// Of a connection: who begins it, a master or an observer, and who is there, a slave.
enum class DtlsRole : std::uint8_t { client, server };

// A usage of our own, from a random UUID (ITU-T X.667).
inline constexpr const char* kObserverUsage = "2.25.189362923666621630541505676026735795596";

struct Certificates {
  std::shared_ptr<x509_st> authority, own;
  std::shared_ptr<evp_pkey_st> private_key;
  std::string name;  // "01234567 of authority 89abcdef", their fingerprints
};

// Tells certificates apart and may be shown: the first 8 hexadecimal digits of its SHA-256.
std::string fingerprint(const x509_st& certificate);

Certificates make_certificates(std::shared_ptr<x509_st> authority, std::shared_ptr<x509_st> own,
                               std::shared_ptr<evp_pkey_st> private_key);

struct CertificateFiles {
  std::filesystem::path authority, certificate, private_key;
};

// Throws a sentence naming the file and the remedy: one is missing, open to others or not such a
// file, the three do not fit together, or the certificate is not for this role or not valid now, by
// the system's clock.
Certificates load_certificates(const CertificateFiles& files, DtlsRole role);

// When the first of the two certificates expires.
std::time_t valid_until(const Certificates& certificates);

// "2027-02-28 12:00 UTC"
std::string date(std::time_t time);

}  // namespace farhand
