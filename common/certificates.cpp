#include "common/certificates.hpp"

#include <openssl/bio.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "common/certificate_rules.hpp"
#include "common/openssl_pointers.hpp"
#include "common/secret_file.hpp"

namespace farhand {
namespace {

constexpr const char* kCopyAgain = "copy it again, whole and unchanged";
constexpr const char* kMakeThem = "make new ones with farhand-keygen --certificates";

using Text = std::unique_ptr<BIO, Freed<BIO_free>>;

// `open_remedy` is for a file that others may use in a way they must not.
Text open_pem(const SecretFile& file, mode_t forbidden, const char* open, const char* open_remedy) {
  std::string text =
      read_secret(file, {.forbidden = forbidden,
                         .open = open,
                         .open_remedy = open_remedy,
                         .missing_remedy = "make it with farhand-keygen --certificates and copy "
                                           "here what is this side's"});
  Text pem(BIO_new(BIO_s_mem()));
  const bool taken =
      pem != nullptr && BIO_write(pem.get(), text.data(), static_cast<int>(text.size())) >= 0;
  OPENSSL_cleanse(text.data(), text.size());
  if (!taken) refuse(file, "is empty", kCopyAgain);
  return pem;
}

// Nobody is there to be asked for one.
int no_passphrase(char*, int, int, void*) {
  return -1;
}

std::shared_ptr<X509> next_certificate(BIO* from) {
  std::shared_ptr<X509> out(PEM_read_bio_X509(from, nullptr, no_passphrase, nullptr), X509_free);
  ERR_clear_error();
  return out;
}

std::shared_ptr<X509> read_certificate(const SecretFile& file) {
  const Text pem =
      open_pem(file, S_IWGRP | S_IWOTH, "may be changed by other users of this machine",
               "run chmod 644 on it after a look at what it holds");
  auto out = next_certificate(pem.get());
  if (!out) refuse(file, "is no certificate in PEM", kCopyAgain);
  if (next_certificate(pem.get()))
    refuse(file, "holds more than one certificate", "leave in it the one that is meant");
  return out;
}

std::shared_ptr<EVP_PKEY> read_private_key(const SecretFile& file) {
  const Text pem =
      open_pem(file, S_IRWXG | S_IRWXO, "is open to other users of this machine",
               "run chmod 600 on it, and make new ones if they may have read it: farhand-keygen "
               "--certificates");
  std::shared_ptr<EVP_PKEY> out(PEM_read_bio_PrivateKey(pem.get(), nullptr, no_passphrase, nullptr),
                                EVP_PKEY_free);
  ERR_clear_error();
  if (!out) refuse(file, "is no private key in PEM without a passphrase", kCopyAgain);
  std::array<char, 32> group{};
  if (EVP_PKEY_get_group_name(out.get(), group.data(), group.size(), nullptr) != 1 ||
      std::string(group.data()) != "prime256v1")
    refuse(file, "is not of ECDSA over P-256", kMakeThem);
  return out;
}

std::time_t seconds_of(const ASN1_TIME* time) {
  std::tm tm{};
  return ASN1_TIME_to_tm(time, &tm) == 1 ? timegm(&tm) : 0;
}

const char* user(DtlsRole role) {
  return role == DtlsRole::client ? "a master or an observer" : "a slave";
}

// What OpenSSL found wrong with the certificate in the file.
[[noreturn]] void refuse_error(const SecretFile& file, X509* certificate, int error,
                               DtlsRole role) {
  const std::string here = date(std::time(nullptr));
  if (error == X509_V_ERR_CERT_HAS_EXPIRED)
    refuse(file, "expired on " + date(seconds_of(X509_get0_notAfter(certificate))),
           std::string(kMakeThem) + ", or set this machine's clock (" + here + ")");
  if (error == X509_V_ERR_CERT_NOT_YET_VALID)
    refuse(file, "is not valid before " + date(seconds_of(X509_get0_notBefore(certificate))),
           "set this machine's clock (" + here + ")");
  if (error == X509_V_ERR_INVALID_PURPOSE)
    refuse(file, std::string("is not for ") + user(role),
           "name the one that farhand-keygen --certificates made for this side");
  refuse(file,
         std::string("is not signed by this side's authority (") +
             X509_verify_cert_error_string(error) + ")",
         "name the authority.pem that the certificate came with");
}

void check_chain(const CertificateFiles& files, const Certificates& c, DtlsRole role) {
  const std::unique_ptr<X509_STORE, Freed<X509_STORE_free>> store(X509_STORE_new());
  const std::unique_ptr<X509_STORE_CTX, Freed<X509_STORE_CTX_free>> chain(X509_STORE_CTX_new());
  if (store == nullptr || chain == nullptr ||
      X509_STORE_add_cert(store.get(), c.authority.get()) != 1 ||
      X509_STORE_CTX_init(chain.get(), store.get(), c.own.get(), nullptr) != 1 ||
      !expect_role(X509_STORE_CTX_get0_param(chain.get()), role))
    throw std::bad_alloc();
  const bool good = X509_verify_cert(chain.get()) == 1;
  ERR_clear_error();
  if (good && names_role(c.own.get(), role)) return;
  const int error = good ? X509_V_ERR_INVALID_PURPOSE : X509_STORE_CTX_get_error(chain.get());
  if (X509_STORE_CTX_get_error_depth(chain.get()) == 0 || good)
    refuse_error({"certificate file", files.certificate}, c.own.get(), error, role);
  refuse_error({"authority file", files.authority}, c.authority.get(), error, role);
}

}  // namespace

bool expect_role(X509_VERIFY_PARAM* of, DtlsRole role) noexcept {
  X509_VERIFY_PARAM_set_depth(of, 0);
  X509_VERIFY_PARAM_set_auth_level(of, 2);
  return X509_VERIFY_PARAM_set_purpose(
             of, role == DtlsRole::client ? X509_PURPOSE_SSL_CLIENT : X509_PURPOSE_SSL_SERVER) == 1;
}

bool names_role(X509* certificate, DtlsRole role) noexcept {
  const std::uint32_t usage = X509_get_extended_key_usage(certificate);
  const std::uint32_t wanted = role == DtlsRole::client ? XKU_SSL_CLIENT : XKU_SSL_SERVER;
  return usage != UINT32_MAX && (usage & wanted) != 0;
}

bool names_observer(const X509* certificate) noexcept {
  int found = 0;  // -1: no usage is named
  const std::unique_ptr<EXTENDED_KEY_USAGE, Freed<EXTENDED_KEY_USAGE_free>> usage(
      static_cast<EXTENDED_KEY_USAGE*>(
          X509_get_ext_d2i(certificate, NID_ext_key_usage, &found, nullptr)));
  const std::unique_ptr<ASN1_OBJECT, Freed<ASN1_OBJECT_free>> wanted(
      OBJ_txt2obj(kObserverUsage, 1));
  if (usage == nullptr || wanted == nullptr) return found != -1;
  for (int i = 0; i < sk_ASN1_OBJECT_num(usage.get()); ++i)
    if (OBJ_cmp(sk_ASN1_OBJECT_value(usage.get(), i), wanted.get()) == 0) return true;
  return false;
}

std::string fingerprint(const x509_st& certificate) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  if (X509_digest(&certificate, EVP_sha256(), digest.data(), nullptr) != 1)
    throw std::runtime_error("OpenSSL has no SHA-256: install an unrestricted libssl3");
  return hexadecimal(digest.data(), 4);
}

Certificates make_certificates(std::shared_ptr<x509_st> authority, std::shared_ptr<x509_st> own,
                               std::shared_ptr<evp_pkey_st> private_key) {
  std::string name = fingerprint(*own) + " of authority " + fingerprint(*authority);
  return {std::move(authority), std::move(own), std::move(private_key), std::move(name)};
}

Certificates load_certificates(const CertificateFiles& files, DtlsRole role) {
  const SecretFile authority{"authority file", files.authority};
  const SecretFile own{"certificate file", files.certificate};
  const SecretFile key{"private key file", files.private_key};
  auto first = read_certificate(authority), second = read_certificate(own);
  Certificates out = make_certificates(std::move(first), std::move(second), read_private_key(key));
  if (i2d_X509(out.own.get(), nullptr) > kMaxCertificateBytes)
    refuse(own, "is longer than " + std::to_string(kMaxCertificateBytes) + " bytes", kMakeThem);
  if (X509_check_ca(out.authority.get()) != 1)
    refuse(authority, "is of nobody who may sign others", "name authority.pem");
  if (X509_check_private_key(out.own.get(), out.private_key.get()) != 1) {
    ERR_clear_error();
    refuse(key, "does not fit the certificate in " + files.certificate.string(),
           "name the two that were made together");
  }
  check_chain(files, out, role);
  return out;
}

std::time_t valid_until(const Certificates& c) {
  return std::min(seconds_of(X509_get0_notAfter(c.authority.get())),
                  seconds_of(X509_get0_notAfter(c.own.get())));
}

std::string date(std::time_t time) {
  std::tm tm{};
  gmtime_r(&time, &tm);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M UTC", &tm);
  return text.data();
}

}  // namespace farhand
